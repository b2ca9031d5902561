// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "lidarena/scenes/mine.hpp"

namespace lidarena::scenes {

/// A straight space with a floor, walls and rounded edges: a gallery between two junctions, a dead
/// end or a chamber. Its ends reach half its width beyond `from` and `to` (on the floor, m).
struct Drift {
  Eigen::Vector3d from, to;
  double width, height;  ///< m
};

/// A gallery with its junctions.
struct Gallery {
  std::size_t from, to;  ///< junctions
  Drift drift;
};

/// Where the rock is removed: galleries on a disturbed grid, and what branches off from them.
struct MinePlan {
  std::vector<Eigen::Vector3d> junctions;  ///< on the floor
  std::vector<Gallery> galleries;
  std::vector<Drift> dead_ends;
  std::vector<Drift> chambers;  ///< each with the neck before it
};

/// Draws the plan. Every junction has at least two galleries, and all are connected; each cell of
/// the grid holds at most one dead end or chamber.
MinePlan plan_mine(const MineConfig& config, std::uint64_t seed);

/// A closed route through every gallery, 1.3 m above the floor and without a reversal on the spot:
/// at each junction it takes the gallery that it has passed least often. The last point equals the
/// first.
std::vector<Eigen::Vector3d> mine_route(const MinePlan& plan);

}  // namespace lidarena::scenes
