// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <tsl/robin_map.h>

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lidarena/map/voxel_key.hpp"

namespace lidarena::map {

/// A point cloud with at most one point per voxel, in insertion order: the first point of a voxel
/// is kept, later ones are rejected. Nothing is averaged, so noise stays visible. Occupied voxels
/// are kept as bits, in blocks of 4 x 4 x 4 voxels in a hash table: neighbors in a scan are
/// neighbors in memory, and a surface takes about 3 bytes per voxel besides the 12 of its point.
class PointMap {
 public:
  /// `voxel_size` in m; memory for `expected` points is reserved at once.
  explicit PointMap(double voxel_size, std::size_t expected = 0);

  /// Adds `point` (m) if it is finite and the first of its voxel; returns whether it was added.
  bool insert(const Eigen::Vector3f& point);
  void insert(std::span<const Eigen::Vector3f> points);

  std::span<const Eigen::Vector3f> points() const { return points_; }
  /// Returns the points and leaves the map empty.
  std::vector<Eigen::Vector3f> take();

  std::size_t size() const { return points_.size(); }
  std::size_t memory_bytes() const;

 private:
  using Blocks = tsl::robin_map<VoxelKey, std::uint64_t, VoxelKeyHash>;

  float inverse_size_;
  std::vector<Eigen::Vector3f> points_;
  Blocks blocks_;  ///< which of a block's 64 voxels are occupied
};

}  // namespace lidarena::map
