// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/map/point_blocks.hpp"

#include <cassert>

namespace lidarena::map {

Eigen::Vector3f* PointBlocks::allocate(int level) {
  const std::size_t count = capacity(level);
  assert(count <= kPagePoints);
  const auto slot = static_cast<std::size_t>(level);
  if (slot < free_.size() && !free_[slot].empty()) {
    Eigen::Vector3f* const block = free_[slot].back();
    free_[slot].pop_back();
    return block;
  }
  if (used_ + count > kPagePoints) {  // the rest of the page is wasted: less than this block
    pages_.emplace_back(new Eigen::Vector3f[kPagePoints]);
    used_ = 0;
  }
  used_ += count;
  return pages_.back().get() + (used_ - count);
}

void PointBlocks::release(Eigen::Vector3f* block, int level) {
  const auto slot = static_cast<std::size_t>(level);
  if (slot >= free_.size()) free_.resize(slot + 1);
  free_[slot].push_back(block);
}

std::size_t PointBlocks::memory_bytes() const {
  std::size_t bytes = pages_.size() * (kPagePoints * sizeof(Eigen::Vector3f) + sizeof(void*));
  for (const auto& list : free_) bytes += list.capacity() * sizeof(void*);
  return bytes;
}

}  // namespace lidarena::map
