// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/flight/flight_config.hpp"
#include "lidarena/world/world.hpp"
#include "lidarena/world/world_model.hpp"

namespace lidarena {

/// A closed way through a world, and what it shows of it. Shares are of the mesh's area, by
/// samples.
struct Tour {
  std::vector<Eigen::Vector3d> waypoints;  ///< the last equals the first
  std::size_t views = 0;                   ///< places chosen to look from
  double cell_m = 0.0;                     ///< edge of the grid's cells in the end
  std::size_t cells = 0;                   ///< that can be reached
  double seeable = 0.0;                    ///< share of the mesh seen from what can be reached
  double seen = 0.0;                       ///< share of the mesh seen along the flight
};

/// Plans a tour of any mesh:
///  1. what can be reached from the start (FreeSpace) inside the mesh's box, at
///     clearance_m + margin_m from every surface, preferably corner_m more;
///  2. places spread over it, and what of the surface is seen from each: together, what can be
///  seen;
///  3. the few of them that see the wanted share of that (greedy set cover);
///  4. their order: nearest neighbor, then 2-opt, by shortest ways, back to the start;
///  5. each way pulled straight as far as the clearance allows;
///  6. corners of the flight that would come too near are flown tighter, by waypoints beside them.
/// The start is `tour.start`, or the first point of the world's first route, or, of a grid of
/// places, the one that is most enclosed by surfaces. Deterministic. Time grows with max_cells,
/// max_views * samples rays, and views * cells; memory is about 150 bytes a cell and a byte for
/// each view of each sample. Throws InputError (naming `place`) when the start is too near to a
/// surface, or no start is found.
Tour plan_tour(const WorldModel& model, const World& world, const FlightConfig& config,
               const std::string& place, const Parallel& parallel);

/// One line for people.
std::string describe(const Tour& tour);

/// The tour as the text of a file of configs/flights, so that it need not be planned again:
/// `config` with its kind made waypoints, to the millimeter.
std::string as_yaml(const Tour& tour, const FlightConfig& config);

}  // namespace lidarena
