// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <tsl/robin_map.h>

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "lidarena/map/voxel_key.hpp"

namespace lidarena::map {

/// Means of the points in each cell of a grid, updated as points are added and removed: a map that
/// moves with a sensor costs time only for what changes. Coordinates are summed in integer
/// micrometers, so removing points leaves no rounding errors. Points that are not finite are left
/// out.
class VoxelSums {
 public:
  /// `voxel_size`: edge of a cell (m).
  explicit VoxelSums(double voxel_size);

  void add(std::span<const Eigen::Vector3f> points);
  /// Removes points that were added with exactly the same coordinates.
  void remove(std::span<const Eigen::Vector3f> points);

  void clear();

  /// The mean of each cell that is not empty; their order depends only on the sequence of calls.
  std::vector<Eigen::Vector3f> means() const;

  std::size_t size() const { return cells_.size(); }
  std::uint64_t memory_bytes() const;

 private:
  struct Cell {
    VoxelKey key = 0;
    Eigen::Matrix<std::int64_t, 3, 1> sum_um = Eigen::Matrix<std::int64_t, 3, 1>::Zero();
    std::int64_t count = 0;
  };
  VoxelKey key_of(const Eigen::Vector3f& point) const;

  float cells_per_meter_;
  std::vector<Cell> cells_;
  tsl::robin_map<VoxelKey, std::uint32_t, VoxelKeyHash> places_;  ///< index in `cells_`
};

}  // namespace lidarena::map
