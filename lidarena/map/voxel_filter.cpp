// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/map/voxel_filter.hpp"

#include <tsl/robin_map.h>

#include <algorithm>
#include <bit>
#include <utility>

#include "lidarena/map/point_map.hpp"
#include "lidarena/map/voxel_key.hpp"

namespace lidarena {

namespace {

/// Indices of the first points of each voxel in the order of our own table.
std::vector<std::uint32_t> in_table_order(std::span<const Eigen::Vector3f> points,
                                          double voxel_size, VoxelRounding rounding) {
  PointMap seen(voxel_size, 0, rounding);
  std::vector<std::uint32_t> kept;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (seen.insert(points[i])) kept.push_back(static_cast<std::uint32_t>(i));
  }
  std::vector<std::uint32_t> indices = seen.shuffled();
  for (std::uint32_t& index : indices) index = kept[index];
  return indices;
}

}  // namespace

std::vector<std::uint32_t> first_of_each_voxel(std::span<const Eigen::Vector3f> points,
                                               double voxel_size, VoxelRounding rounding) {
  PointMap seen(voxel_size, 0, rounding);
  std::vector<std::uint32_t> kept;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (seen.insert(points[i])) kept.push_back(static_cast<std::uint32_t>(i));
  }
  return kept;
}

std::vector<std::uint32_t> thinned_indices(std::span<const Eigen::Vector3f> points,
                                           double voxel_size, const Thinning& thinning) {
  if (thinning.order == ThinningOrder::kMixed)
    return in_table_order(points, voxel_size, thinning.rounding);
  const std::uint32_t y_factor = thinning.order == ThinningOrder::kTeschner ? 19349663U : 19349669U;
  const auto inverse_size = static_cast<float>(1.0 / voxel_size);
  // a table twice as large as its input, slots in a power of two; who comes late stands behind
  const auto mask = static_cast<std::uint32_t>(std::bit_ceil(2 * points.size() + 1) - 1);
  const auto slot = [&](std::uint32_t i) {
    const Eigen::Array<std::uint32_t, 3, 1> voxel =
        voxel_of(points[i], inverse_size, thinning.rounding).cast<std::uint32_t>();
    return (voxel.x() * 73856093U ^ voxel.y() * y_factor ^ voxel.z() * 83492791U) & mask;
  };
  std::vector<std::pair<std::uint32_t, std::uint32_t>> slots_and_indices;
  for (const std::uint32_t i : first_of_each_voxel(points, voxel_size, thinning.rounding))
    slots_and_indices.emplace_back(slot(i), i);
  std::sort(slots_and_indices.begin(), slots_and_indices.end());
  std::vector<std::uint32_t> indices;
  for (const auto& [slot_taken, i] : slots_and_indices) indices.push_back(i);
  return indices;
}

std::vector<Eigen::Vector3f> thin(std::span<const Eigen::Vector3f> points, double voxel_size,
                                  const Thinning& thinning) {
  std::vector<Eigen::Vector3f> thinned;
  for (const std::uint32_t i : thinned_indices(points, voxel_size, thinning))
    thinned.push_back(points[i]);
  return thinned;
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
