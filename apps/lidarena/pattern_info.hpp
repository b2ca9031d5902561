// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "lidarena/base/config_json.hpp"
#include "lidarena/sensor/sensor_config.hpp"

namespace lidarena {

/// Prints a sensor's first `count` shots as CSV: index, dt_ns since the start, x, y, z, ring.
void print_rays(const SensorConfig& sensor, std::size_t count);

/// How much of its field of view a sensor lights in 0.1, 0.5, 1 and 4 s. The field of view is the
/// data sheet's, or where that is not known the smallest box around the first second's shots.
/// With `svg`, draws it there too.
Json pattern_info(const SensorConfig& sensor, const std::filesystem::path& svg);

}  // namespace lidarena
