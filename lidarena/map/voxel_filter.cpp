// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/map/voxel_filter.hpp"

#include "lidarena/map/point_map.hpp"

namespace lidarena {

std::vector<std::uint32_t> first_of_each_voxel(std::span<const Eigen::Vector3f> points,
                                               double voxel_size) {
  PointMap seen(voxel_size);
  std::vector<std::uint32_t> kept;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (seen.insert(points[i])) kept.push_back(static_cast<std::uint32_t>(i));
  }
  return kept;
}

std::vector<Eigen::Vector3f> thin(std::span<const Eigen::Vector3f> points, double voxel_size) {
  PointMap seen(voxel_size);
  seen.insert(points);
  return seen.take_shuffled();
}

}  // namespace lidarena
