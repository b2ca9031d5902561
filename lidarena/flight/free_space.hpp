// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/world/world.hpp"

namespace lidarena::flight {

/// Distances from surfaces.
struct Distances {
  double minimum = 0.0;    ///< m, minimum everywhere
  double preferred = 0.0;  ///< m, kept where possible; below it path lengths count three times
};

/// The space that can be reached from a starting point inside the mesh's bounding box: cells of a
/// cubic grid with a point that keeps the minimum distance from every surface. Two neighboring
/// cells are connected if the line between their points keeps the minimum distance, too. In narrow
/// places the point is moved by hill climbing away from the surfaces within its cell, so that doors
/// are passed regardless of their position relative to the grid.
class FreeSpace {
 public:
  static constexpr std::int32_t kNone = -1;
  struct Cell {
    Eigen::Vector3d point;
    double clearance;                  ///< m, at the point; larger distances are stored as 1 m
    std::array<std::int32_t, 6> next;  ///< neighbors in -x, +x, -y, +y, -z, +z, or kNone
  };

  /// Explores from `start` with cells of edge `voxel_size_m`, or larger ones if there would be more
  /// than `max_voxels`, which is estimated with cells of four times the edge. Empty when `start`
  /// itself is too close to a surface or outside the box.
  FreeSpace(const world::World& world, const Eigen::Vector3d& start, const Distances& distances,
            double voxel_size_m, std::size_t max_voxels, const Parallel& parallel);

  std::span<const Cell> cells() const { return cells_; }
  double voxel_size_m() const { return voxel_size_m_; }
  /// Lengths of the shortest paths along neighbors from one cell to all cells, in half cell edges;
  /// steps below the preferred distance count three times.
  std::vector<std::int32_t> lengths_from(std::int32_t from) const;
  /// The cells on a shortest path, both ends included.
  std::vector<std::int32_t> path(std::int32_t from, std::int32_t to) const;
  bool is_wide(std::int32_t cell) const {
    return cells_[static_cast<std::size_t>(cell)].clearance >= distances_.preferred;
  }
  const Distances& distances() const { return distances_; }

 private:
  /// Fills `cells_`; returns false when there are more than `max_voxels`.
  bool explore(const world::World& world, const Eigen::Vector3d& start, std::size_t max_voxels,
               const Parallel& parallel);

  Distances distances_;
  double voxel_size_m_;
  std::vector<Cell> cells_;
};

/// Whether every point of the line segment keeps `clearance` (sphere tracing; a violation by less
/// than 1 cm between two query points may be missed).
bool is_clear(const world::World& world, const Eigen::Vector3d& from, const Eigen::Vector3d& to,
              double clearance);

}  // namespace lidarena::flight
