// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>

namespace lidarena::loop {

/// Appearance of a place from above, for any heading: the maximum height in each cell of a polar
/// grid around it (Kim, Kim, "Scan Context", IROS 2018). Rows are rings, columns sectors.
struct PlaceDescriptor {
  static constexpr int kRings = 20;
  static constexpr int kSectors = 60;
  Eigen::Matrix<float, kRings, kSectors> heights;  ///< m above the lowest that counts; 0: empty
  Eigen::Matrix<float, kRings, 1> ring_means;      ///< does not depend on the heading
};

/// The descriptor of points (m) in the frame of the place, z up, out to `range` m.
PlaceDescriptor describe(std::span<const Eigen::Vector3f> points, double range);

struct Resemblance {
  double distance = 1.0;      ///< 0 equal, 1 nothing in common
  double rotation_rad = 0.0;  ///< rad about z: rotated by it, the second place matches the first
};
Resemblance compare(const PlaceDescriptor& first, const PlaceDescriptor& second);

}  // namespace lidarena::loop
