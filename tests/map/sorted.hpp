// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

namespace lidarena::map {

/// The points in the order of their coordinates.
inline std::vector<Eigen::Vector3f> sorted(std::vector<Eigen::Vector3f> points) {
  std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  });
  return points;
}

}  // namespace lidarena::map
