// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "lidarena/flight/flight.hpp"
#include "lidarena/world/mover_config.hpp"
#include "lidarena/world/world.hpp"

namespace lidarena::flight {

/// `count` people drawn from `seed`, who walk forth and back on straight pieces of free floor in
/// sight of the flight (or stand, where there is no room), at least kPeopleClearance from its path
/// in plan. Fewer where no free floor is found. They may meet each other.
std::vector<world::MoverConfig> draw_people(const world::World& world, const Flight& flight,
                                            int count, std::uint64_t seed);

inline constexpr double kPeopleClearance = 0.9;  ///< m, from the path to a person's axis

}  // namespace lidarena::flight
