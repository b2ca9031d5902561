// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/map/voxel_filter.hpp"

#include <tsl/robin_map.h>

#include "lidarena/map/point_map.hpp"
#include "lidarena/map/voxel_key.hpp"

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

std::vector<Eigen::Vector3f> voxel_means(std::span<const Eigen::Vector3f> points,
                                         double voxel_size) {
  const auto inverse_size = static_cast<float>(1.0 / voxel_size);
  tsl::robin_map<VoxelKey, std::uint32_t, VoxelKeyHash> cells;
  std::vector<Eigen::Vector3f> sums;
  std::vector<std::uint32_t> counts;
  for (const Eigen::Vector3f& point : points) {
    if (!point.allFinite()) continue;
    const auto next = static_cast<std::uint32_t>(sums.size());
    const auto [cell, is_new] = cells.try_emplace(voxel_key(voxel_of(point, inverse_size)), next);
    if (is_new) {
      sums.emplace_back(Eigen::Vector3f::Zero());
      counts.push_back(0);
    }
    sums[cell->second] += point;
    ++counts[cell->second];
  }
  for (std::size_t i = 0; i < sums.size(); ++i) sums[i] /= static_cast<float>(counts[i]);
  return sums;
}

}  // namespace lidarena
