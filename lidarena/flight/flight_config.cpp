// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/flight_config.hpp"

namespace lidarena::flight {

FlightLimits limits_of(FlightStyle style) {
  switch (style) {
    case FlightStyle::kGentle:
      return {1.0, 1.0, 10.0, 0.2, 0.6};
    case FlightStyle::kBrisk:
      return {2.5, 3.0, 30.0, 0.5, 1.5};
    case FlightStyle::kAggressive:
      break;
  }
  return {5.0, 7.0, 100.0, 0.9, 5.0};
}

FlightLimits limits_of(const FlightConfig& config) {
  const FlightLimits style = limits_of(config.style);
  const LimitsConfig& own = config.limits;
  const double s = config.speed;
  return {.max_speed = s * own.max_speed.value_or(style.max_speed),
          .max_acceleration = s * s * own.max_acceleration.value_or(style.max_acceleration),
          .max_jerk = s * s * s * own.max_jerk.value_or(style.max_jerk),
          .max_tilt = own.max_tilt.value_or(style.max_tilt),
          .max_yaw_rate = s * own.max_yaw_rate.value_or(style.max_yaw_rate)};
}

}  // namespace lidarena::flight
