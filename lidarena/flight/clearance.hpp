// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

#include "lidarena/flight/flight.hpp"
#include "lidarena/world/world.hpp"

namespace lidarena::flight {

/// Point at which a flight comes too close to a surface.
struct Encounter {
  Time time{0};
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< of the body
  Eigen::Vector3d surface = Eigen::Vector3d::Zero();   ///< nearest point of the surface
  double distance = 0.0;                               ///< m; 0 when the path passes through
};

/// First instant at which the body's center is closer than `clearance` (m) to the mesh or passes
/// through it. The distance to a surface changes by at most the path length flown. The world is
/// therefore queried again only when the path length reaches the remaining margin; the path between
/// two queries is clear by the same argument, up to the path length flown in 5 ms.
std::optional<Encounter> first_encounter(const Flight& flight, const world::World& world,
                                         double clearance);

}  // namespace lidarena::flight
