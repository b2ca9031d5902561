// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/map/point_map.hpp"

#include <algorithm>
#include <bit>
#include <iterator>

#include "lidarena/base/error.hpp"

namespace lidarena {

namespace {
/// Slots for `count` points at a load of at most 5/8.
std::size_t slots_for(std::size_t count) {
  return std::bit_ceil(std::max<std::size_t>(64, count * 8 / 5 + 1));
}
}  // namespace

PointMap::PointMap(double voxel_size, std::size_t expected, VoxelRounding rounding)
    : inverse_size_(static_cast<float>(1.0 / voxel_size)), rounding_(rounding) {
  if (!(voxel_size > 0.0)) throw InputError("voxel_size", "must be above 0 m");
  points_.reserve(expected);
  resize_table(slots_for(expected));
}

bool PointMap::insert(const Eigen::Vector3f& point) {
  if (!point.allFinite()) return false;
  const std::size_t slot = find_slot(key_of(point));
  if (slots_[slot] != kFree) return false;
  slots_[slot] = static_cast<std::uint32_t>(points_.size());
  points_.push_back(point);
  if (slots_for(points_.size()) > slots_.size()) resize_table(slots_for(points_.size()));
  return true;
}

void PointMap::insert(std::span<const Eigen::Vector3f> points) {
  for (const Eigen::Vector3f& point : points) insert(point);
}

std::vector<Eigen::Vector3f> PointMap::take() {
  std::vector<Eigen::Vector3f> points = std::move(points_);
  points_ = {};
  slots_ = {};
  resize_table(slots_for(0));
  return points;
}

std::vector<std::uint32_t> PointMap::shuffled() const {
  std::vector<std::uint32_t> indices;
  indices.reserve(points_.size());
  std::copy_if(slots_.begin(), slots_.end(), std::back_inserter(indices),
               [](std::uint32_t index) { return index != kFree; });
  return indices;
}

std::size_t PointMap::memory_bytes() const {
  return points_.capacity() * sizeof(Eigen::Vector3f) + slots_.capacity() * sizeof(std::uint32_t);
}

std::size_t PointMap::find_slot(VoxelKey key) const {
  const std::size_t mask = slots_.size() - 1;
  std::size_t slot = VoxelKeyHash{}(key)&mask;
  while (slots_[slot] != kFree && key_of(points_[slots_[slot]]) != key) slot = (slot + 1) & mask;
  return slot;
}

void PointMap::resize_table(std::size_t slot_count) {
  std::vector<std::uint32_t>(slot_count, kFree).swap(slots_);
  for (std::size_t i = 0; i < points_.size(); ++i) {
    slots_[find_slot(key_of(points_[i]))] = static_cast<std::uint32_t>(i);
  }
}

}  // namespace lidarena
