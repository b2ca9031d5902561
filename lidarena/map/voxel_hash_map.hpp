// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <tsl/robin_map.h>

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "lidarena/map/neighbor.hpp"
#include "lidarena/map/point_blocks.hpp"
#include "lidarena/map/voxel_key.hpp"

namespace lidarena::map {

/// A local map: a hash table from cubic cells to a few points each, as in Vizzo et al., "KISS-ICP"
/// (RA-L 2023), section III-D. Points are stored as float: resolution 8 um at 100 m, 0.06 mm at 1
/// km.
class VoxelHashMap {
 public:
  struct Options {
    double voxel_size = 1.0;   ///< edge of a cell, m
    int max_points = 20;       ///< per cell (1..4096); later points are rejected
    double min_spacing = 0.0;  ///< m; points nearer to another one of their cell are rejected
    VoxelRounding rounding = VoxelRounding::kFloor;
  };

  /// Throws InputError on invalid options.
  explicit VoxelHashMap(const Options& options);

  /// Adds one point (m, map frame); returns whether it was added. Points that are not finite are
  /// rejected.
  bool insert(const Eigen::Vector3f& point);
  void insert(std::span<const Eigen::Vector3f> points);

  /// Removes each cell whose first point is `radius` (m) or more from `center`.
  void remove_far(const Eigen::Vector3f& center, double radius);

  /// Nearest point to `query` in its cell and the 26 around it, nearer than `max_distance` (m): the
  /// nearest of the whole map if that is at most `voxel_size` away.
  std::optional<Neighbor> nearest(const Eigen::Vector3f& query, float max_distance) const;

  /// Writes the points nearest to `query`, nearer than `radius` (m), to `out`, at most as many as
  /// it holds, not sorted but in the same order for the same map; returns how many were found.
  /// Searches (2 ceil(radius / voxel_size) + 1)^3 cells, except those beyond the farthest point in
  /// `out`.
  std::size_t nearest(const Eigen::Vector3f& query, float radius, std::span<Neighbor> out) const;

  bool empty() const { return cells_.empty(); }
  std::size_t size() const { return size_; }  ///< points
  std::size_t cell_count() const { return cells_.size(); }
  std::vector<Eigen::Vector3f> points() const;
  std::size_t memory_bytes() const;

 private:
  struct Cell {
    Eigen::Vector3f* points = nullptr;
    std::uint16_t count = 0;
    std::uint8_t level = 0;  ///< of the block, see PointBlocks
  };

  Voxel cell_of(const Eigen::Vector3f& point) const {
    return voxel_of(point, inverse_size_, options_.rounding);
  }
  void append(Cell& cell, const Eigen::Vector3f& point);

  Options options_;
  float size_m_;
  float inverse_size_;
  float squared_spacing_;
  tsl::robin_map<VoxelKey, Cell, VoxelKeyHash> cells_;
  PointBlocks blocks_;
  std::size_t size_ = 0;
};

}  // namespace lidarena::map
