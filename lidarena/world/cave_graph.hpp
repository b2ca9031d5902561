// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "lidarena/world/cave.hpp"

namespace lidarena {

/// A tunnel's centerline between two junctions, as a polyline with a radius at each point.
struct Tunnel {
  std::size_t from = 0;  ///< junctions
  std::size_t to = 0;
  std::vector<Eigen::Vector3d> points;  ///< about 0.5 m apart
  std::vector<double> radii;            ///< m, before roughness

  double length() const;
};

/// The cave before rock is put around it.
struct CaveGraph {
  std::vector<Eigen::Vector3d> junctions;
  std::vector<Tunnel> tunnels;
  /// The tunnels around each cell of the ladder.
  std::vector<std::vector<std::size_t>> loops;
};

/// Draws the maze of `config`: a ladder, bent in plan and height, of tunnels that wind.
CaveGraph make_cave_graph(const CaveConfig& config, std::uint64_t seed);

/// A closed way through every tunnel that nowhere turns on the spot: it weaves from rail to rail
/// over the rungs to the far end and comes back over the other rails, so that inner rungs are flown
/// twice. Points are 1 to 2 m apart; the last equals the first.
std::vector<Eigen::Vector3d> cave_route(const CaveGraph& graph);

}  // namespace lidarena
