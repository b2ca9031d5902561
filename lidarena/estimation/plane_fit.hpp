// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <utility>

#include "lidarena/base/config.hpp"

namespace lidarena::estimation {

/// normal . x + offset = 0, with a unit normal.
struct Plane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double offset = 0.0;  ///< m
};

/// How a plane is fitted to points.
enum class PlaneFit {
  kUnitOffset,  ///< least squares of a . x = -1, which no plane through the origin satisfies
  kPrincipal,   ///< across the direction in which the points vary least
};

constexpr auto enum_names(PlaneFit) {
  return std::array{std::pair{"unit_offset", PlaneFit::kUnitOffset},
                    std::pair{"principal", PlaneFit::kPrincipal}};
}

/// Five points (m) as columns: the neighborhood that LiDAR odometries fit their shapes to.
using FivePoints = Eigen::Matrix<double, 3, 5>;

/// Principal axes of five points.
struct PrincipalAxes {
  Eigen::Vector3d center;  ///< m, their mean
  Eigen::Vector3d
      spread;  ///< m^2, sums of squared distances from the mean along each axis, ascending
  Eigen::Matrix3d axes;  ///< unit columns, in the same order
};
PrincipalAxes principal_axes(const FivePoints& points);

/// The plane through five points, none if one of them lies farther than `max_distance` (m) from it,
/// or, for kPrincipal and a `min_aspect` above 0, if their spread along the plane is narrower than
/// that share of its length: points on a line fit any plane through it.
std::optional<Plane> fit_plane(const FivePoints& points, PlaneFit method, double max_distance,
                               double min_aspect = 0.0);

}  // namespace lidarena::estimation
