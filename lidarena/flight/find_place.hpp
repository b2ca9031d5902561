// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "lidarena/base/pose.hpp"
#include "lidarena/flight/flight.hpp"
#include "lidarena/world/world.hpp"
#include "lidarena/world/world_model.hpp"

namespace lidarena::flight {

/// Where in the world a flight that knows nothing of it has most room: the turn about z and the
/// shift by which its path stays farthest from all surfaces. The middle of the path is tried at
/// each meter of the world's routes, up to 1 m above and below, in 24 directions. Throws InputError
/// (place `name`) if the world has no route, or the path comes within `clearance_m` of a surface
/// everywhere.
Pose find_place(const Flight& flight, const world::WorldModel& model, const world::World& world,
                double clearance_m, const std::string& name);

}  // namespace lidarena::flight
