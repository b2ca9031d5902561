// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "lidarena/flight/flight.hpp"
#include "lidarena/flight/quadrotor_config.hpp"

namespace lidarena {

/// The flight of a quadrotor (see Quadrotor, Gusts) that a controller (tracking_wrench) keeps near
/// `reference`, for as long as that lasts. The body begins hovering at the reference's first pose
/// in still air. The states, integrated by steps of 2 ms (Runge-Kutta 4), become a
/// PoseSplineFlight of 8 ms knots: 49 kB per second of flight.
/// Throws InputError (naming `place`) when the rotors cannot lift the body, or when it is lost:
/// farther than 3 m from the reference.
std::unique_ptr<Flight> fly_quadrotor(const Flight& reference, const DynamicsConfig& config,
                                      const std::string& place);

/// How far a flight is from the one that it follows, over samples 5 ms apart.
struct TrackingError {
  double rms_m = 0.0, max_m = 0.0;
  double max_angle = 0.0;  ///< rad
};
TrackingError tracking_error(const Flight& flown, const Flight& reference);

}  // namespace lidarena
