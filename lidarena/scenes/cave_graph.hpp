// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "lidarena/scenes/cave.hpp"

namespace lidarena::scenes {

/// A tunnel's centerline between two junctions, as a polyline with a radius at each point.
struct Tunnel {
  std::size_t from = 0;  ///< indices of the junctions at both ends
  std::size_t to = 0;
  std::vector<Eigen::Vector3d> points;  ///< about 0.5 m apart
  std::vector<double> radii;            ///< m, without roughness

  double length() const;
};

/// The junctions and tunnels of a cave, from which its surface is generated.
struct CaveGraph {
  std::vector<Eigen::Vector3d> junctions;
  std::vector<Tunnel> tunnels;
  /// For each loop (cell of the ladder), the indices of its tunnels.
  std::vector<std::vector<std::size_t>> loops;
};

/// Generates the maze at random: winding tunnels in a ladder that is bent in plan and height.
/// Throws InputError when the tunnel widths leave no room for the roughness.
CaveGraph make_cave_graph(const CaveConfig& config, std::uint64_t seed);

/// A closed route through every tunnel without a reversal on the spot: it crosses from rail to rail
/// at every rung up to the far end and returns along the other rails, so inner rungs are traversed
/// twice. Points are 1 to 2 m apart; the last equals the first.
std::vector<Eigen::Vector3d> cave_route(const CaveGraph& graph);

}  // namespace lidarena::scenes
