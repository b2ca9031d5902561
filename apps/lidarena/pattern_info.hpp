// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "lidarena/base/config_json.hpp"
#include "lidarena/sensor/sensor_config.hpp"

namespace lidarena {

/// Prints a sensor's first `count` shots as CSV: index, dt_ns since the start, x, y, z, ring.
void print_rays(const sensor::SensorConfig& sensor, std::size_t count);

/// Share of a sensor's field of view that its shots cover in 0.1, 0.5, 1 and 4 s. The field of view
/// is that of the data sheet or, if unknown, the smallest box around the shots of the first second.
/// If `svg` is not empty, also writes a drawing of the covered cells to it.
Json pattern_info(const sensor::SensorConfig& sensor, const std::filesystem::path& svg);

}  // namespace lidarena
