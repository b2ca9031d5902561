// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/map/random_thinning.hpp"

#include <tsl/robin_map.h>

#include <algorithm>
#include <bit>
#include <numeric>
#include <tuple>
#include <utility>

namespace lidarena::map {

namespace {

/// Pseudo-random rank, unique for each index: two rounds of a bijective mix.
std::uint32_t rank_of(std::uint32_t index) {
  index = (index ^ (index >> 16U)) * 0x7FEB352DU;  // constants of Wellons' hash prospector
  index = (index ^ (index >> 15U)) * 0x846CA68BU;
  return index ^ (index >> 16U);
}

}  // namespace

std::vector<std::uint32_t> one_per_voxel(std::span<const VoxelKey> voxels) {
  struct Cell {
    std::uint64_t order;   // low bits of the hash
    std::uint32_t first;   // index of the first point met in the cell
    std::uint32_t chosen;  // index of its point of the lowest rank
  };
  const std::uint64_t order_bits = std::bit_ceil(voxels.size() + 1) - 1;
  std::vector<Cell> cells;
  tsl::robin_map<VoxelKey, std::size_t, VoxelKeyHash> index_of_cell;
  index_of_cell.reserve(voxels.size() / 2);
  for (std::uint32_t i = 0; i < voxels.size(); ++i) {
    const auto [found, is_new] = index_of_cell.try_emplace(voxels[i], cells.size());
    if (is_new) {
      cells.push_back({VoxelKeyHash{}(voxels[i]) & order_bits, i, i});
    } else if (Cell& cell = cells[found->second]; rank_of(i) < rank_of(cell.chosen)) {
      cell.chosen = i;
    }
  }
  std::sort(cells.begin(), cells.end(), [](const Cell& a, const Cell& b) {
    return std::tie(a.order, a.first) < std::tie(b.order, b.first);
  });
  std::vector<std::uint32_t> kept;
  kept.reserve(cells.size());
  for (const Cell& cell : cells) kept.push_back(cell.chosen);
  return kept;
}

std::vector<std::uint32_t> drawn(std::size_t size, std::size_t count) {
  std::vector<std::uint32_t> indices(size);
  std::iota(indices.begin(), indices.end(), 0U);
  if (size <= count) return indices;
  std::sort(indices.begin(), indices.end(),
            [](std::uint32_t a, std::uint32_t b) { return rank_of(a) < rank_of(b); });
  indices.resize(count);
  return indices;
}

}  // namespace lidarena::map
