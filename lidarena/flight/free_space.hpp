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

namespace lidarena {

/// How near to surfaces a body may come.
struct Distances {
  double least = 0.0;      ///< m, kept everywhere
  double preferred = 0.0;  ///< m, kept where there is room; ways with less count three times
};

/// What can be reached from a place inside the mesh's box: the cells of a cubic grid in which a
/// point keeps the least distance to every surface, joined where the straight way between two
/// neighbors' points keeps it too. In narrow places the point is the one of its cell that hill
/// climbing finds farthest from the surface, so that a door need not lie on the grid.
class FreeSpace {
 public:
  static constexpr std::int32_t kNone = -1;
  struct Cell {
    Eigen::Vector3d point;
    double clearance;                  ///< m, at the point; distances beyond 1 m are not told apart
    std::array<std::int32_t, 6> next;  ///< neighbors in -x, +x, -y, +y, -z, +z, or kNone
  };

  /// Explores from `start` with cells of `cell_m`, or larger ones if there would be more than
  /// `max_cells`: a first look with cells four times as long tells. Empty when `start` itself is
  /// too near to a surface or outside the box.
  FreeSpace(const World& world, const Eigen::Vector3d& start, const Distances& distances,
            double cell_m, std::size_t max_cells, const Parallel& parallel);

  std::span<const Cell> cells() const { return cells_; }
  double cell_m() const { return cell_m_; }
  /// Lengths of the shortest ways along neighbors from one cell to all, in half cells.
  std::vector<std::int32_t> lengths_from(std::int32_t from) const;
  /// The cells on a shortest way, both ends included.
  std::vector<std::int32_t> way(std::int32_t from, std::int32_t to) const;
  bool is_wide(std::int32_t cell) const {
    return cells_[static_cast<std::size_t>(cell)].clearance >= distances_.preferred;
  }
  const Distances& distances() const { return distances_; }

 private:
  /// Sets cells_; false when they are more than `max_cells`.
  bool explore(const World& world, const Eigen::Vector3d& start, std::size_t max_cells,
               const Parallel& parallel);

  Distances distances_;
  double cell_m_;
  std::vector<Cell> cells_;
};

/// Whether every point of the straight way keeps `clearance` (sphere tracing; what dips below by
/// less than 1 cm between two places asked may be missed).
bool is_clear(const World& world, const Eigen::Vector3d& from, const Eigen::Vector3d& to,
              double clearance);

}  // namespace lidarena
