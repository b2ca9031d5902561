// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

#include "lidarena/flight/flight.hpp"
#include "lidarena/world/world.hpp"

namespace lidarena {

/// Where a flight comes too near to a surface.
struct Encounter {
  Time time{0};
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< of the body
  Eigen::Vector3d surface = Eigen::Vector3d::Zero();   ///< nearest point of it
  double distance = 0.0;                               ///< m; 0 when the path passes through
};

/// First instant at which the body's center is nearer than `clearance` m to the mesh or passes
/// through it. The distance to a surface changes by no more than the way flown, so nothing is
/// asked again before the margin is used up: what lies between two samples is clear by the same
/// law, up to the way flown in 5 ms.
std::optional<Encounter> first_encounter(const Flight& flight, const World& world,
                                         double clearance);

}  // namespace lidarena
