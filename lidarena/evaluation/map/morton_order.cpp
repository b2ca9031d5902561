// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/map/morton_order.hpp"

#include "lidarena/evaluation/map/parallel_sort.hpp"
#include "lidarena/map/voxel_key.hpp"

namespace lidarena::evaluation {
namespace {

/// The 21 low bits of `x`, each moved to every third bit.
std::uint64_t spread(std::uint64_t x) {
  x = (x | x << 32U) & 0x001F00000000FFFFULL;
  x = (x | x << 16U) & 0x001F0000FF0000FFULL;
  x = (x | x << 8U) & 0x100F00F00F00F00FULL;
  x = (x | x << 4U) & 0x10C30C30C30C30C3ULL;
  return (x | x << 2U) & 0x1249249249249249ULL;
}

std::uint64_t code_of(const Eigen::Vector3f& point) {
  constexpr auto kCellsPerMeter = static_cast<float>(1.0 / MortonOrder::kCell_m);
  const map::Voxel voxel = map::voxel_of(point, kCellsPerMeter);
  const auto part = [&](int axis) {
    return spread(static_cast<std::uint64_t>(voxel[axis] + (1 << 20)));
  };
  return part(0) | part(1) << 1U | part(2) << 2U;
}

}  // namespace

MortonOrder morton_order(std::span<const Eigen::Vector3f> points, const Parallel& parallel) {
  MortonOrder order;
  order.entries.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite()) continue;
    order.entries.push_back({code_of(points[i]), static_cast<std::uint32_t>(i)});
  }
  parallel_sort(std::span(order.entries), parallel);
  return order;
}

}  // namespace lidarena::evaluation
