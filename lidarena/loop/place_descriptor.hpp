// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>

namespace lidarena {

/// What a place looks like from above, whichever way one faces: the greatest height in each cell of
/// a polar grid about it (Kim, Kim, "Scan Context", IROS 2018). Rows are rings, columns sectors.
struct PlaceDescriptor {
  static constexpr int kRings = 20;
  static constexpr int kSectors = 60;
  Eigen::Matrix<float, kRings, kSectors> heights;  ///< m above the lowest a cell may be; 0 empty
  Eigen::Matrix<float, kRings, 1> ring_means;      ///< does not change when turned
};

/// Of points (m) seen from the place, z up, out to `range` m.
PlaceDescriptor describe(std::span<const Eigen::Vector3f> points, double range);

struct Resemblance {
  double distance = 1.0;  ///< 0 alike, 1 nothing in common
  double turn = 0.0;      ///< rad about z: the second place, turned by it, looks like the first
};
Resemblance compare(const PlaceDescriptor& first, const PlaceDescriptor& second);

}  // namespace lidarena
