// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/pose.hpp"
#include "lidarena/estimation/feature_residuals.hpp"
#include "lidarena/map/feature_map.hpp"

namespace lidarena::odometry::arena_slam {

/// Directions in which the points do not determine the pose, by the share of all information in
/// each, so that the number of points does not matter. `lever` (m) is the points' RMS range, which
/// scales rotations to translations.
estimation::Degenerate find_degenerate(const estimation::PoseEquations& points, double lever);

struct RegistrationLimits {
  double max_plane_thickness_m = 0.06;
  int max_iterations = 30;
};

struct Registration {
  Pose map_from_lidar = Pose::Identity();
  int iterations = 0;
  bool converged = false;
  estimation::PoseEquations points;  ///< of the last iteration; count 0: the pose is the guess
  int degenerate_directions = 0;
};

/// Gauss-Newton on edges to lines and surface points to planes, from `guess` (LIO-SAM, eq. 10-13).
/// Lines and planes are kept while steps are small.
Registration register_features(const map::Features& features, const map::FeatureMap& map,
                               const Pose& guess, const RegistrationLimits& limits,
                               const Parallel& parallel);

}  // namespace lidarena::odometry::arena_slam
