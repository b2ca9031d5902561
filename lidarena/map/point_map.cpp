// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/map/point_map.hpp"

#include <utility>

namespace lidarena::map {

bool PointMap::insert(const Eigen::Vector3f& point) {
  const std::size_t before = points_.size();
  insert(std::span(&point, 1));
  return points_.size() > before;
}

void PointMap::insert(std::span<const Eigen::Vector3f> points) {
  added_.clear();
  voxels_.insert(points, added_);
  for (const std::uint32_t i : added_) points_.push_back(points[i]);
}

std::vector<Eigen::Vector3f> PointMap::take() {
  voxels_.clear();
  return std::exchange(points_, {});
}

}  // namespace lidarena::map
