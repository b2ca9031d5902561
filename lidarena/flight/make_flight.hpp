// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>

#include "lidarena/base/log.hpp"
#include "lidarena/flight/flight.hpp"
#include "lidarena/world/world.hpp"
#include "lidarena/world/world_model.hpp"

namespace lidarena {

/// Builds the flight that `file` describes (a YAML of configs/flights, or a TUM trajectory to
/// replay) in `world`, whose own routes `model` carries.
/// Throws InputError when the path leaves less than the configured clearance to the mesh (it names
/// the place and the time), exceeds its own limits, or the world has no route where one is asked.
std::unique_ptr<Flight> make_flight(const std::filesystem::path& file, const WorldModel& model,
                                    const World& world, LogSink& log);

}  // namespace lidarena
