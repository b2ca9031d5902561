// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/pose.hpp"
#include "lidarena/estimation/least_squares.hpp"
#include "lidarena/estimation/plane_fit.hpp"
#include "lidarena/map/kd_tree.hpp"
#include "lidarena/odometry/arena_slam/config.hpp"
#include "lidarena/odometry/arena_slam/features.hpp"

namespace lidarena::odometry::arena_slam {

inline constexpr std::size_t kNeighbors = 5;
using Neighbors = std::array<map::Neighbor, kNeighbors>;
/// Errors of a pose: rotation (rad, about the sensor, world axes), then translation (m, world).
using PoseEquations = estimation::NormalEquations<6>;

struct Line {
  Eigen::Vector3d center;
  Eigen::Vector3d direction;  ///< unit
};
/// Line fitted to the points, if the eigenvalue of their spread along it is more than three times
/// that across it.
std::optional<Line> fit_line(const Neighbors& points);

/// Distance (m) of a point from its line or plane and its derivative by the pose's errors, both
/// times the weight of the match; nothing if the weight is too small.
struct PointResidual {
  double distance = 0.0;
  Eigen::Matrix<double, 1, 6> row;
};
std::optional<PointResidual> edge_residual(const Eigen::Vector3d& point, const Line& line,
                                           const Pose& map_from_lidar);
std::optional<PointResidual> surface_residual(const Eigen::Vector3d& point,
                                              const estimation::Plane& plane,
                                              const Pose& map_from_lidar);

/// Directions in which the points do not determine the pose.
struct Degenerate {
  Eigen::Matrix<double, 6, 6> observed = Eigen::Matrix<double, 6, 6>::Identity();  ///< projection
  int directions = 0;
};
/// By the eigenvalues of J^T J (Zhang, Kaess, Singh, "On Degeneracy of Optimization-based State
/// Estimation Problems", ICRA 2016). `lever` (m) is the points' RMS range, which scales
/// rotations to translations; used by Degeneracy::kShare.
Degenerate find_degenerate(const PoseEquations& equations, double lever, Degeneracy rule);

/// Map with which a scan is matched.
struct FeatureMap {
  map::KdTree edges;
  map::KdTree surfaces;
};

struct Registration {
  Pose map_from_lidar = Pose::Identity();
  int iterations = 0;
  bool converged = false;
  PoseEquations points;  ///< of the last iteration; count 0: the pose is the guess
  int degenerate_directions = 0;
};

/// Gauss-Newton on edges to lines and surface points to planes, from `guess` (LIO-SAM, eq. 10-13).
Registration register_features(const Features& features, const FeatureMap& map, const Pose& guess,
                               const Config& config, const Parallel& parallel);

}  // namespace lidarena::odometry::arena_slam
