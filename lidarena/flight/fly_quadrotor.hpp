// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "lidarena/flight/flight.hpp"
#include "lidarena/flight/quadrotor_config.hpp"

namespace lidarena::flight {

/// The flight of a simulated quadrotor (see Quadrotor, Gusts) whose controller (tracking_wrench)
/// follows `reference`, with the same duration. The body starts hovering at the reference's first
/// pose in still air. The states, integrated with steps of 2 ms (Runge-Kutta 4), are fitted by a
/// PoseSplineFlight with 8 ms knots: 49 kB per second of flight.
/// Throws InputError (place `place`) when the rotors cannot lift the body, or when the body is more
/// than 3 m from the reference.
std::unique_ptr<Flight> fly_quadrotor(const Flight& reference, const DynamicsConfig& config,
                                      const std::string& place);

/// Deviation of a flight from its reference, over samples 5 ms apart.
struct TrackingError {
  double rms_m = 0.0, max_m = 0.0;
  double max_angle = 0.0;  ///< rad
};
TrackingError tracking_error(const Flight& flown, const Flight& reference);

}  // namespace lidarena::flight
