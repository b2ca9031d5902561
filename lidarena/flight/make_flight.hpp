// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lidarena/base/log.hpp"
#include "lidarena/flight/flight.hpp"
#include "lidarena/flight/flight_config.hpp"
#include "lidarena/world/world.hpp"
#include "lidarena/world/world_model.hpp"

namespace lidarena::flight {

/// The configuration that `file` has with `set` ("key=value") over it; of a TUM file, that of its
/// replay with a clearance of 0: it must only not pass through a surface.
FlightConfig load_flight(const std::filesystem::path& file,
                         const std::vector<std::string>& set = {});

/// Builds the flight that `file` describes (a YAML file as in configs/flights, or a TUM trajectory
/// to replay) in `world`; `model` provides the world's routes. `gust_seed`, if given, takes the
/// place of the file's seed of the gusts. `set`: see load_flight().
/// Throws InputError when the path comes closer to the mesh than the configured clearance (with
/// position and time), exceeds its limits, or the world does not have the selected route.
std::unique_ptr<Flight> make_flight(const std::filesystem::path& file,
                                    const world::WorldModel& model, const world::World& world,
                                    LogSink& log,
                                    std::optional<std::uint64_t> gust_seed = std::nullopt,
                                    const std::vector<std::string>& set = {});

}  // namespace lidarena::flight
