// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/pose.hpp"
#include "lidarena/map/kd_tree.hpp"

namespace lidarena::loop {

/// Result of the alignment of points to points.
struct PointAlignment {
  Pose target_from_source = Pose::Identity();
  bool converged = false;
  double fitness = 0.0;  ///< m^2, mean squared distance to the nearest target points in reach
};

/// Iterated closest points, point to point (Besl, McKay 1992), from `guess`, with correspondences
/// up to `reach` (m). Not converged: too few of them, or steps still too large at the last
/// iteration.
PointAlignment align_points(std::span<const Eigen::Vector3f> source, const map::KdTree& target,
                            const Pose& guess, double reach, const Parallel& parallel);

/// How far ICP reaches at its start (m).
inline constexpr double kIcpReach = 2.0;

/// Result of the alignment of one cloud to another.
struct IcpResult {
  Pose target_from_source = Pose::Identity();
  bool converged = false;
  int iterations = 0;
  double fitness = 0.0;     ///< m^2, mean squared distance to the target points within 0.3 m
  double overlap = 0.0;     ///< share of the source's points with a target point within 0.3 m
  double constraint = 0.0;  ///< share of the least constrained direction in all information
};

/// Iterated closest points on planes (Chen, Medioni 1991) from `guess`. The maximum distance of
/// correspondences shrinks from kIcpReach to 0.3 m over the iterations. Fitness and overlap are
/// those of the final pose. Not converged: too few correspondences, or steps still too large at the
/// last iteration.
IcpResult align_clouds(std::span<const Eigen::Vector3f> source, const map::KdTree& target,
                       const Pose& guess, const Parallel& parallel);

}  // namespace lidarena::loop
