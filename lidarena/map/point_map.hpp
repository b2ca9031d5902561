// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lidarena/map/voxel_key.hpp"

namespace lidarena {

/// Points in the order they came, at most one a voxel: the first point met in a voxel stays, later
/// ones are refused. Never averages, so noise stays visible. 12 bytes a point and 4 bytes a slot
/// of an open-addressing table that is at most 5/8 full.
class PointMap {
 public:
  /// `voxel_size` in m; room for `expected` points is made at once.
  explicit PointMap(double voxel_size, std::size_t expected = 0,
                    VoxelRounding rounding = VoxelRounding::kFloor);

  /// Whether `point` (m) is the first of its voxel; points that are not finite are refused.
  bool insert(const Eigen::Vector3f& point);
  void insert(std::span<const Eigen::Vector3f> points);

  std::span<const Eigen::Vector3f> points() const { return points_; }
  /// Hands the points over and leaves the map empty.
  std::vector<Eigen::Vector3f> take();
  /// Indices of points() in the order of the table: mixed, yet the same for the same input.
  std::vector<std::uint32_t> shuffled() const;

  std::size_t size() const { return points_.size(); }
  std::size_t memory_bytes() const;

 private:
  static constexpr std::uint32_t kFree = 0xFFFFFFFFU;

  VoxelKey key_of(const Eigen::Vector3f& p) const {
    return voxel_key(voxel_of(p, inverse_size_, rounding_));
  }
  /// Slot that holds the point with `key`, or the free slot where it belongs.
  std::size_t find_slot(VoxelKey key) const;
  void resize_table(std::size_t slot_count);

  float inverse_size_;
  VoxelRounding rounding_;
  std::vector<Eigen::Vector3f> points_;
  std::vector<std::uint32_t> slots_;  ///< index into points_, or kFree; size is a power of two
};

}  // namespace lidarena
