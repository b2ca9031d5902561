// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

#include "lidarena/base/log.hpp"
#include "lidarena/flight/flight.hpp"
#include "lidarena/world/world.hpp"
#include "lidarena/world/world_model.hpp"

namespace lidarena::flight {

/// Builds the flight that `file` describes (a YAML file as in configs/flights, or a TUM trajectory
/// to replay) in `world`; `model` provides the world's routes. `gust_seed`, if given, takes the
/// place of the file's seed of the gusts.
/// Throws InputError when the path comes closer to the mesh than the configured clearance (with
/// position and time), exceeds its limits, or the world does not have the selected route.
std::unique_ptr<Flight> make_flight(const std::filesystem::path& file,
                                    const world::WorldModel& model, const world::World& world,
                                    LogSink& log,
                                    std::optional<std::uint64_t> gust_seed = std::nullopt);

}  // namespace lidarena::flight
