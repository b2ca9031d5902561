// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>

#include "lidarena/base/parallel.hpp"
#include "lidarena/map/neighborhood.hpp"
#include "lidarena/map/voxel_hash_map.hpp"
#include "lidarena/odometry/arena_lo/prediction.hpp"
#include "lidarena/odometry/arena_lo/sampling.hpp"

namespace lidarena::odometry::arena_lo {

struct Registration {
  estimation::ElasticMotion motion;  ///< of the lidar in the map; the guess if `failed`
  int iterations = 0;
  std::size_t matches = 0;     ///< matched keypoints in the last iteration
  double observability = 1.0;  ///< see estimation::observability_of
  /// There were fewer than 50 matches, or the motion is not finite, ends more than 5 m from where
  /// it was expected to begin, or rotates by more than lost_rotation_rad.
  bool failed = false;
};

/// Match of a keypoint, at `position` (m, map) with the present motion, with the plane through the
/// mean of a neighborhood: the flatter and the nearer, the more it weighs.
estimation::ElasticMatch plane_match(const TimedPoint& keypoint, const Eigen::Vector3d& position,
                                     const map::Neighborhood& near,
                                     const RegistrationConfig& config);

/// Elastic ICP of `keypoints` against `map`: alternates neighbor searches and Gauss-Newton steps.
Registration register_keypoints(std::span<const TimedPoint> keypoints, const map::VoxelHashMap& map,
                                const Expectation& expected, const RegistrationConfig& config,
                                const Parallel& parallel);

}  // namespace lidarena::odometry::arena_lo
