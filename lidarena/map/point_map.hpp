// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <tsl/robin_map.h>

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lidarena/map/voxel_key.hpp"

namespace lidarena {

/// Points in the order they came, at most one a voxel: the first point met in a voxel stays, later
/// ones are refused. Never averages, so noise stays visible. Which voxels are taken is kept in bits,
/// 4 x 4 x 4 voxels together in a hash table: neighbors of a scan are neighbors in memory, and a
/// surface takes some 3 bytes a voxel besides the 12 of its point.
class PointMap {
 public:
  /// `voxel_size` in m; room for `expected` points is made at once.
  explicit PointMap(double voxel_size, std::size_t expected = 0);

  /// Whether `point` (m) is the first of its voxel; points that are not finite are refused.
  bool insert(const Eigen::Vector3f& point);
  void insert(std::span<const Eigen::Vector3f> points);

  std::span<const Eigen::Vector3f> points() const { return points_; }
  /// Hands the points over and leaves the map empty.
  std::vector<Eigen::Vector3f> take();

  std::size_t size() const { return points_.size(); }
  std::size_t memory_bytes() const;

 private:
  using Blocks = tsl::robin_map<VoxelKey, std::uint64_t, VoxelKeyHash>;

  float inverse_size_;
  std::vector<Eigen::Vector3f> points_;
  Blocks blocks_;  ///< which of a block's 64 voxels are taken
};

}  // namespace lidarena
