// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/flight/flight_config.hpp"
#include "lidarena/world/world.hpp"
#include "lidarena/world/world_model.hpp"

namespace lidarena::flight {

/// A closed path through a world and its coverage. Shares are shares of the mesh's area, estimated
/// by samples.
struct Tour {
  std::vector<Eigen::Vector3d> waypoints;  ///< the last equals the first
  std::size_t views = 0;                   ///< number of chosen viewpoints
  double voxel_size_m = 0.0;               ///< final edge of the grid's cells
  std::size_t cells = 0;                   ///< number of reachable cells
  double seeable = 0.0;                    ///< share of the mesh visible from reachable space
  double seen = 0.0;                       ///< share of the mesh seen along the flight
};

/// Plans a tour of any mesh:
///  1. determine the space that can be reached from the start (FreeSpace) inside the mesh's
///     bounding box, at clearance_m + margin_m from every surface, preferably corner_m more;
///  2. distribute candidate viewpoints over it and determine the surface that each sees; together
///     they define the visible surface;
///  3. choose a small set of viewpoints that sees the required share of it (greedy set cover);
///  4. order them by shortest paths, back to the start: nearest neighbor, then 2-opt;
///  5. shorten each path by straight segments as far as the clearance allows;
///  6. tighten corners where the flight would come too close to a surface, by extra waypoints.
/// The start is `tour.start`, or the first point of the world's first route, or the point of a grid
/// that is most enclosed by surfaces. Deterministic. Time grows with max_voxels, max_views *
/// samples rays, and views * cells; memory is about 150 bytes per cell plus one byte per view and
/// sample. Throws InputError (place `place`) when the start is too close to a surface, or no start
/// is found.
Tour plan_tour(const world::WorldModel& model, const world::World& world,
               const FlightConfig& config, const std::string& place, const Parallel& parallel);

/// One-line summary for the log.
std::string describe(const Tour& tour);

/// The tour as the text of a flight file, so that it need not be planned again: `config` with kind
/// waypoints and the tour's waypoints, rounded to the millimeter.
std::string as_yaml(const Tour& tour, const FlightConfig& config);

}  // namespace lidarena::flight
