// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

namespace lidarena::estimation {

/// normal . x + offset = 0, with a unit normal.
struct Plane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double offset = 0.0;  ///< m
};

/// Five points (m) as columns: the neighborhood that LiDAR odometries fit their shapes to.
using FivePoints = Eigen::Matrix<double, 3, 5>;

/// The plane through five points, none if one of them lies farther than `max_distance` (m) from it:
/// least squares of a . x = -1, which no plane through the origin satisfies, in single precision,
/// as the programs of LOAM's family solve it.
std::optional<Plane> fit_plane(const FivePoints& points, double max_distance);

}  // namespace lidarena::estimation
