// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/map/occupied_voxels.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include "lidarena/base/error.hpp"

namespace lidarena::map {
namespace {

constexpr std::size_t kBatch = 64;        // points whose blocks are fetched from memory at once
constexpr std::size_t kFirstSlots = 256;  // of a new table

}  // namespace

OccupiedVoxels::OccupiedVoxels(double voxel_size)
    : inverse_size_(static_cast<float>(1.0 / voxel_size)) {
  if (!(voxel_size > 0.0)) throw InputError("voxel_size", "must be above 0 m");
}

OccupiedVoxels::Place OccupiedVoxels::place_of(const Eigen::Vector3f& point) const {
  if (!point.allFinite()) return {};
  const Voxel voxel = voxel_of(point, inverse_size_);
  const Voxel block(voxel.x() >> 2, voxel.y() >> 2, voxel.z() >> 2);
  const int bit = (voxel.x() & 3) | (voxel.y() & 3) << 2 | (voxel.z() & 3) << 4;
  return {voxel_key(block), std::uint64_t{1} << static_cast<unsigned>(bit)};
}

bool OccupiedVoxels::take_voxel(const Place& place) {
  std::size_t slot = first_slot(place.block);
  while (blocks_[slot].taken != 0 && blocks_[slot].key != place.block)
    slot = (slot + 1) & (blocks_.size() - 1);
  Block& block = blocks_[slot];
  if ((block.taken & place.bit) != 0) return false;
  if (block.taken == 0) ++used_;
  block.key = place.block;
  block.taken |= place.bit;
  return true;
}

void OccupiedVoxels::reserve_blocks(std::size_t more) {
  if (2 * (used_ + more) <= blocks_.size()) return;
  const std::size_t slots = std::bit_ceil(std::max(kFirstSlots, 2 * (used_ + more)));
  const std::vector<Block> old = std::exchange(blocks_, std::vector<Block>(slots));
  for (const Block& block : old) {
    if (block.taken == 0) continue;
    std::size_t slot = first_slot(block.key);
    while (blocks_[slot].taken != 0) slot = (slot + 1) & (slots - 1);
    blocks_[slot] = block;
  }
}

void OccupiedVoxels::insert(std::span<const Eigen::Vector3f> points,
                            std::vector<std::uint32_t>& added) {
  std::array<Place, kBatch> places;
  for (std::size_t begin = 0; begin < points.size(); begin += kBatch) {
    const std::size_t count = std::min(kBatch, points.size() - begin);
    reserve_blocks(count);
    for (std::size_t i = 0; i < count; ++i) {
      places[i] = place_of(points[begin + i]);
      __builtin_prefetch(&blocks_[first_slot(places[i].block)], 1);
    }
    for (std::size_t i = 0; i < count; ++i) {
      if (places[i].bit != 0 && take_voxel(places[i]))
        added.push_back(static_cast<std::uint32_t>(begin + i));
    }
  }
}

void OccupiedVoxels::clear() {
  blocks_ = {};
  used_ = 0;
}

}  // namespace lidarena::map
