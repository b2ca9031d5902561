// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lidarena/map/voxel_key.hpp"

namespace lidarena::map {

/// Which voxels hold a point. They are bits, in blocks of 4 x 4 x 4 voxels in a hash table:
/// neighbors in a scan are neighbors in memory, and a surface takes about 3 bytes per voxel.
class OccupiedVoxels {
 public:
  /// `voxel_size` in m; throws InputError unless it is above 0.
  explicit OccupiedVoxels(double voxel_size);

  /// Appends to `added` the indices of the points (m) that are finite and the first of their voxel.
  /// Most of the time goes into waiting for memory, which is fetched ahead.
  void insert(std::span<const Eigen::Vector3f> points, std::vector<std::uint32_t>& added);
  void clear();
  std::size_t memory_bytes() const { return blocks_.size() * sizeof(Block); }

 private:
  /// Which of a block's 64 voxels are occupied; none: the slot of the table is free.
  struct Block {
    VoxelKey key = 0;
    std::uint64_t taken = 0;
  };
  /// Place of a point: its block and the bit of its voxel; no bit: the point is not finite.
  struct Place {
    VoxelKey block = 0;
    std::uint64_t bit = 0;
  };

  Place place_of(const Eigen::Vector3f& point) const;
  /// Index of the slot at which the search for a block begins.
  std::size_t first_slot(VoxelKey block) const {
    return VoxelKeyHash{}(block) & (blocks_.size() - 1);
  }
  /// Marks the voxel; returns whether it was free. The table has a free slot.
  bool take_voxel(const Place& place);
  /// Grows the table so that it is at most half full after `more` blocks.
  void reserve_blocks(std::size_t more);

  float inverse_size_;
  std::vector<Block> blocks_;  ///< open addressing with linear probing; the size is a power of two
  std::size_t used_ = 0;       ///< slots that are not free
};

}  // namespace lidarena::map
