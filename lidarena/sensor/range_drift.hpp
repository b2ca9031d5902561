// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "lidarena/base/time.hpp"
#include "lidarena/sensor/error_config.hpp"

namespace lidarena::sensor {

/// Bias of all ranges, m, at `t` after the start of the flight: the temperature of the LiDAR
/// approaches that of its surroundings exponentially (Newton's law of cooling), so
///   warm_up_m exp(-(on_for_s + t) / tau) + per_kelvin_m change_k (1 - exp(-t / tau)).
inline double range_drift(const DriftConfig& config, Time t) {
  const double rest = std::exp(-to_seconds(t) / config.time_constant_s);
  const double at_start = std::exp(-config.on_for_s / config.time_constant_s);
  return config.warm_up_m * at_start * rest + config.per_kelvin_m * config.change_k * (1.0 - rest);
}

}  // namespace lidarena::sensor
