// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/base/parallel.hpp"
#include "lidarena/map/feature_map.hpp"
#include "lidarena/odometry/lio_sam/config.hpp"

namespace lidarena::odometry::lio_sam {

struct Registration {
  Pose map_from_lidar = Pose::Identity();
  int iterations = 0;  ///< 0: there were too few matches, the pose is the guess
  bool converged = false;
  std::size_t matches = 0;
  int degenerate_directions = 0;
};

/// Gauss-Newton on edges to lines and surface points to planes, from `guess` (eq. 10-13).
/// Directions in which the points of the first iteration have an eigenvalue below 100 keep the
/// guess.
Registration register_features(const map::Features& features, const map::FeatureMap& map,
                               const Pose& guess, Sensor sensor, const Parallel& parallel);

}  // namespace lidarena::odometry::lio_sam
