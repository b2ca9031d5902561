// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/map/voxel_filter.hpp"

#include <tsl/robin_map.h>

#include <utility>

#include "lidarena/base/error.hpp"
#include "lidarena/map/voxel_key.hpp"

namespace lidarena::map {

namespace {

/// The points that are the first of their voxels: a hash table of their indices with open
/// addressing, at most 5/8 full.
class FirstPoints {
 public:
  FirstPoints(std::span<const Eigen::Vector3f> points, double voxel_size, VoxelRounding rounding)
      : points_(points),
        inverse_size_(static_cast<float>(1.0 / voxel_size)),
        rounding_(rounding),
        slots_(kMinSlots, kFree) {
    if (!(voxel_size > 0.0)) throw InputError("voxel_size", "must be above 0 m");
    for (std::size_t i = 0; i < points.size(); ++i)
      if (points[i].allFinite()) offer(static_cast<std::uint32_t>(i));
  }

  /// Indices in the order of the points.
  std::vector<std::uint32_t> take() { return std::move(kept_); }

 private:
  static constexpr std::uint32_t kFree = 0xFFFFFFFFU;
  static constexpr std::size_t kMinSlots = 64;

  VoxelKey key_of(std::uint32_t i) const {
    return voxel_key(voxel_of(points_[i], inverse_size_, rounding_));
  }
  /// Slot that holds the point with `key`, or the free slot where it belongs.
  std::size_t find_slot(VoxelKey key) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t slot = VoxelKeyHash{}(key)&mask;
    while (slots_[slot] != kFree && key_of(slots_[slot]) != key) slot = (slot + 1) & mask;
    return slot;
  }
  void offer(std::uint32_t i) {
    const std::size_t slot = find_slot(key_of(i));
    if (slots_[slot] != kFree) return;
    slots_[slot] = i;
    kept_.push_back(i);
    if (kept_.size() * 8 / 5 + 1 <= slots_.size()) return;
    slots_.assign(2 * slots_.size(), kFree);
    for (const std::uint32_t kept : kept_) slots_[find_slot(key_of(kept))] = kept;
  }

  std::span<const Eigen::Vector3f> points_;
  float inverse_size_;
  VoxelRounding rounding_;
  std::vector<std::uint32_t> kept_;
  std::vector<std::uint32_t> slots_;  ///< index or kFree; the size is a power of two
};

}  // namespace

std::vector<std::uint32_t> first_of_each_voxel(std::span<const Eigen::Vector3f> points,
                                               double voxel_size, VoxelRounding rounding) {
  return FirstPoints(points, voxel_size, rounding).take();
}

std::vector<Eigen::Vector3f> voxel_means(std::span<const Eigen::Vector3f> points, double voxel_size,
                                         GridAxes axes) {
  const Eigen::Matrix3f cells_from_points = (grid_from_points(axes) / voxel_size).cast<float>();
  tsl::robin_map<VoxelKey, std::uint32_t, VoxelKeyHash> cells(points.size() / 4);
  std::vector<Eigen::Vector3f> sums;
  std::vector<std::uint32_t> counts;
  for (const Eigen::Vector3f& point : points) {
    if (!point.allFinite()) continue;
    const auto next = static_cast<std::uint32_t>(sums.size());
    const auto [cell, is_new] =
        cells.try_emplace(voxel_key(voxel_of(cells_from_points * point, 1.0F)), next);
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

}  // namespace lidarena::map
