// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lidarena/map/voxel_key.hpp"

/// Thinning by pseudo-random choice. The choice depends on the input only.
namespace lidarena::map {

/// For points with these voxels, the indices of one point of each voxel, drawn uniformly from those
/// in it. Their order is that of the hashes of the voxels, which looks random.
std::vector<std::uint32_t> one_per_voxel(std::span<const VoxelKey> voxels);

/// `count` of the indices 0 ... size - 1, drawn uniformly, in random order; all in ascending order
/// if there are not more.
std::vector<std::uint32_t> drawn(std::size_t size, std::size_t count);

/// The voxels of items with a `position` (m).
template <class Item>
std::vector<VoxelKey> voxels_of(std::span<const Item> items, double voxel_size,
                                VoxelRounding rounding = VoxelRounding::kFloor) {
  const auto inverse_size = static_cast<float>(1.0 / voxel_size);
  std::vector<VoxelKey> voxels;
  voxels.reserve(items.size());
  for (const Item& item : items)
    voxels.push_back(voxel_key(voxel_of(item.position, inverse_size, rounding)));
  return voxels;
}

/// The items with these indices.
template <class T>
std::vector<T> selected(std::span<const T> items, std::span<const std::uint32_t> indices) {
  std::vector<T> chosen;
  chosen.reserve(indices.size());
  for (const std::uint32_t index : indices) chosen.push_back(items[index]);
  return chosen;
}

}  // namespace lidarena::map
