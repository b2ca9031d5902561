// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "lidarena/flight/flight.hpp"

namespace lidarena::flight {

/// Key figures of a flight; maxima over samples 1 ms apart.
struct FlightFigures {
  double duration_s = 0.0;
  double length_m = 0.0;
  double max_speed = 0.0;                 ///< m/s
  double max_acceleration = 0.0;          ///< m/s^2
  double max_tilt = 0.0;                  ///< rad, of the body's z axis from the vertical
  double max_angular_rate = 0.0;          ///< rad/s
  double max_angular_acceleration = 0.0;  ///< rad/s^2
  double fast_share = 0.0;                ///< share of the time above 2 m/s or above 90 deg/s
};

FlightFigures figures_of(const Flight& flight);

/// One-line summary for the log.
std::string describe(const FlightFigures& figures);

}  // namespace lidarena::flight
