// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

#include "lidarena/base/pose.hpp"
#include "lidarena/estimation/least_squares.hpp"
#include "lidarena/estimation/plane_fit.hpp"

namespace lidarena::estimation {

/// Errors of a pose: rotation (rad, about the sensor, world axes), then translation (m, world).
using PoseEquations = NormalEquations<6>;
/// `pose` after a step of these errors.
Pose moved(const Pose& pose, const PoseEquations::Vector& step);

struct Line {
  Eigen::Vector3d center;     ///< m
  Eigen::Vector3d direction;  ///< unit
};
/// Line fitted to the points, if the eigenvalue of their spread along it is more than three times
/// that across it.
std::optional<Line> fit_line(const FivePoints& points);

/// Distance (m) of a point from its line or plane and its derivative by the pose's errors, both
/// times the weight of the match.
struct FeatureResidual {
  double distance = 0.0;
  Eigen::Matrix<double, 1, 6> row;
  void add_to(PoseEquations& sum) const;
};
/// Residual of an edge point (m, LiDAR frame) and its line in the map (LIO-SAM, eq. 10); the weight
/// decreases with the distance. Nothing if it is too small.
std::optional<FeatureResidual> edge_residual(const Eigen::Vector3d& point, const Line& line,
                                             const Pose& map_from_lidar);
/// Likewise of a surface point and its plane (LIO-SAM, eq. 11); the weight decreases with the
/// distance over the root of the range.
std::optional<FeatureResidual> surface_residual(const Eigen::Vector3d& point, const Plane& plane,
                                                const Pose& map_from_lidar);

/// Directions in which the points do not determine the pose.
struct Degenerate {
  PoseEquations::Matrix observed = PoseEquations::Matrix::Identity();  ///< projection of a step
  int directions = 0;
};
/// Those with an eigenvalue of J^T J below `min_eigenvalue` (Zhang, Kaess, Singh, "On Degeneracy of
/// Optimization-based State Estimation Problems", ICRA 2016).
Degenerate find_degenerate(const PoseEquations::Matrix& hessian, double min_eigenvalue);

}  // namespace lidarena::estimation
