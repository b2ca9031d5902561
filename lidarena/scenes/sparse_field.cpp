// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/scenes/sparse_field.hpp"

#include <utility>

namespace lidarena::scenes {

std::uint64_t SparseField::key(const Eigen::Vector3i& c) {
  constexpr std::uint64_t kMask = (1U << 21) - 1;
  return (static_cast<std::uint64_t>(c.x()) & kMask) |
         ((static_cast<std::uint64_t>(c.y()) & kMask) << 21) |
         ((static_cast<std::uint64_t>(c.z()) & kMask) << 42);
}

std::size_t SparseField::index_in_block(const Eigen::Vector3i& sample) {
  constexpr int kMask = kBlock - 1;
  return static_cast<std::size_t>((sample.x() & kMask) +
                                  kBlock * ((sample.y() & kMask) + kBlock * (sample.z() & kMask)));
}

SparseField::Values& SparseField::add_block(const Eigen::Vector3i& coordinates) {
  index_.emplace(key(coordinates), blocks_.size());
  blocks_.push_back({coordinates, {}});
  return blocks_.back().values;
}

const float* SparseField::find(const Eigen::Vector3i& sample) const {
  const Eigen::Vector3i block(sample.x() >> 3, sample.y() >> 3, sample.z() >> 3);
  static_assert(kBlock == 1 << 3);
  const auto found = index_.find(key(block));
  if (found == index_.end()) return nullptr;
  return &blocks_[found->second].values[index_in_block(sample)];
}

float* SparseField::find(const Eigen::Vector3i& sample) {
  return const_cast<float*>(std::as_const(*this).find(sample));
}

}  // namespace lidarena::scenes
