// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <tsl/robin_map.h>

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lidarena/map/neighbor.hpp"
#include "lidarena/map/point_blocks.hpp"
#include "lidarena/map/voxel_key.hpp"

namespace lidarena {

/// A local map: a hash table from cubic cells to a few points each, as in Vizzo et al., "KISS-ICP"
/// (RA-L 2023), section III-D. Points are kept as float: 8 um at 100 m, 0.06 mm at 1 km.
class VoxelHashMap {
 public:
  struct Options {
    double voxel_size = 1.0;   ///< edge of a cell, m
    int max_points = 20;       ///< of a cell; later ones are refused (1..4096)
    double min_spacing = 0.0;  ///< m; a point nearer to another one of its own cell is refused
    VoxelRounding rounding = VoxelRounding::kFloor;
    /// Above 0: cells find the plane through their points; variance (m^2) across it at most this
    /// part of the middle one.
    double plane_thinness = 0.0;
  };
  struct Plane {
    Eigen::Vector3f mean;    ///< of the cell's points, m
    Eigen::Vector3f normal;  ///< unit, either way
  };
  /// The nearest point and what its cell looks like.
  struct Match : Neighbor {
    bool found = false;
    const Plane* plane = nullptr;  ///< of the point's cell; null if it is not flat
    /// Where planes are fitted: the point's cell has fewer than five points, or they lie on a line,
    /// so that they show the sensor's scan pattern rather than a surface.
    bool shapeless = false;
    explicit operator bool() const { return found; }
  };

  /// Throws InputError on options that make no sense.
  explicit VoxelHashMap(const Options& options);

  /// Adds one point (m, map frame); whether it was taken. Points that are not finite are refused.
  bool insert(const Eigen::Vector3f& point);
  void insert(std::span<const Eigen::Vector3f> points);

  /// Drops each cell whose first point is `radius` (m) or more from `center`.
  void remove_far(const Eigen::Vector3f& center, double radius);

  /// Nearest point to `query` among its cell and the 26 around, nearer than `max_distance`: the
  /// true nearest one if that is at most `voxel_size` away.
  Match nearest(const Eigen::Vector3f& query, float max_distance) const;

  /// The points nearest to `query` among those nearer than `radius`, as many as `out` holds, in an
  /// order that is the same for the same map; returns how many were found. Looks up
  /// (2 ceil(radius / edge) + 1)^3 cells, less those that begin beyond the farthest one in `out`.
  std::size_t nearest(const Eigen::Vector3f& query, float radius, std::span<Neighbor> out) const;

  bool empty() const { return cells_.empty(); }
  std::size_t size() const { return size_; }  ///< points
  std::size_t cell_count() const { return cells_.size(); }
  std::vector<Eigen::Vector3f> points() const;
  std::size_t memory_bytes() const;

 private:
  static constexpr std::uint32_t kNoPlane = 0xFFFFFFFFU;
  static constexpr std::uint32_t kShapeless = 0xFFFFFFFEU;  ///< and up: no plane either
  struct Cell {
    Eigen::Vector3f* points = nullptr;
    std::uint16_t count = 0;
    std::uint8_t level = 0;            ///< of the block, see PointBlocks
    std::uint32_t plane = kShapeless;  ///< in planes_, or one of the above
  };

  Voxel cell_of(const Eigen::Vector3f& point) const {
    return voxel_of(point, inverse_size_, options_.rounding);
  }
  /// Finds the plane through the cell's points anew.
  void fit_plane(Cell& cell);
  /// Leaves the cell without a plane: kNoPlane or kShapeless.
  void release_plane(Cell& cell, std::uint32_t instead);
  void append(Cell& cell, const Eigen::Vector3f& point);

  Options options_;
  float size_m_;
  float inverse_size_;
  float squared_spacing_;
  tsl::robin_map<VoxelKey, Cell, VoxelKeyHash> cells_;
  PointBlocks blocks_;
  std::vector<Plane> planes_;
  std::vector<std::uint32_t> free_planes_;
  std::size_t size_ = 0;
};

}  // namespace lidarena
