// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>

#include "lidarena/map/neighbor.hpp"

namespace lidarena::map {

/// Shape of the map's points around a query.
struct Neighborhood {
  Eigen::Vector3d mean;    ///< m, map frame
  Eigen::Vector3d normal;  ///< unit, direction of the smallest variance, either sign
  /// (s2 - s3) / s1 with the standard deviations s1 >= s2 >= s3 along the principal axes: 1 for a
  /// plane of equal extent in all its directions, 0 for a line, a ball or a single point.
  double planarity = 0.0;
};

/// Describes at least one neighbor.
Neighborhood describe(std::span<const Neighbor> neighbors);

}  // namespace lidarena::map
