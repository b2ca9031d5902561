// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/pose.hpp"
#include "lidarena/loop/config.hpp"
#include "lidarena/map/kd_tree.hpp"

namespace lidarena {

/// How well one cloud came to lie on another.
struct IcpResult {
  Pose target_from_source = Pose::Identity();
  bool converged = false;
  int iterations = 0;
  double fitness = 0.0;     ///< m^2, mean squared distance to the nearest points within reach
  double overlap = 0.0;     ///< share of the source's points with a target point within `inlier_m`
  double constraint = 0.0;  ///< of the least held direction, turning on one scale with shifting
};

/// Iterated closest points (Besl, McKay 1992; with planes: Chen, Medioni 1991) from `guess`. With
/// planes the reach shrinks from `correspondence_m` to `inlier_m` as the clouds come together.
/// Fitness and overlap are those of the end. Not converged: without correspondences, or still
/// moving after the last iteration.
IcpResult align_clouds(std::span<const Eigen::Vector3f> source, const KdTree& target,
                       const Pose& guess, const LoopConfig& config, const Parallel& parallel);

}  // namespace lidarena
