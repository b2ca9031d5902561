// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "lidarena/base/config.hpp"

namespace lidarena::flight {

/// Wind and gusts. Each axis of the gusts is an approximately Gaussian stationary process with the
/// spectrum of the longitudinal Dryden model (see Gusts). Both are faded in over the first second
/// of the flight.
struct GustConfig {
  Eigen::Vector3d wind = Eigen::Vector3d::Zero();
  double gust_speed = 0.0;
  double correlation_time_s = 1.0;
  std::uint64_t seed = 1;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("wind", self.wind, "m/s", "mean velocity of the air, world frame");
    v("gust_speed", self.gust_speed, "m/s", "standard deviation of the gusts on each axis; 0 = off",
      between(0, 20));
    v("correlation_time_s", self.correlation_time_s, "s", "correlation time of the gusts",
      between(0.1, 100));
    v("seed", self.seed, "", "seed of the gusts");
  }
};

/// A quadrotor in X configuration and its controller. The defaults describe a 1.5 kg airframe that
/// carries a LiDAR: inertia, torque per thrust and motor lag are those of the Iris in PX4's Gazebo
/// models (lag between its 12.5 ms up and 25 ms down), thrust its 5.84e-6 N s^2 * (1100 rad/s)^2;
/// arm and drag are assumptions (drag of the order of magnitude in Faessler, Franchi, Scaramuzza,
/// "Differential flatness of quadrotor dynamics subject to rotor drag", RA-L 2018).
struct DynamicsConfig {
  double mass_kg = 1.5;
  Eigen::Vector3d inertia{0.029125, 0.029125, 0.055225};
  double arm_m = 0.25;
  double max_thrust = 7.1;
  double torque_per_thrust = 0.06;
  double motor_lag_s = 0.02;
  double drag_per_s = 0.3;
  double position_bandwidth = 3.0;
  double tilt_bandwidth = 15.0;
  double yaw_bandwidth = 6.0;
  double damping = 0.9;
  GustConfig gusts;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("mass_kg", self.mass_kg, "kg", "total mass including payload", above(0));
    v("inertia", self.inertia, "kg m^2", "moments of inertia about the body's x, y, z", above(0));
    v("arm_m", self.arm_m, "m", "distance from the center to each motor", above(0));
    v("max_thrust", self.max_thrust, "N", "thrust of one rotor at full speed", above(0));
    v("torque_per_thrust", self.torque_per_thrust, "m",
      "reaction torque of a rotor about its axis per thrust", above(0));
    v("motor_lag_s", self.motor_lag_s, "s", "time constant of a rotor's speed", between(0.004, 1));
    v("drag_per_s", self.drag_per_s, "1/s",
      "rotor drag perpendicular to the thrust: deceleration per airspeed", between(0, 10));
    v("position_bandwidth", self.position_bandwidth, "rad/s",
      "natural frequency of the position controller", above(0));
    v("tilt_bandwidth", self.tilt_bandwidth, "rad/s",
      "natural frequency of the roll and pitch controller", above(0));
    v("yaw_bandwidth", self.yaw_bandwidth, "rad/s", "natural frequency of the heading controller",
      above(0));
    v("damping", self.damping, "", "damping ratio of the three controllers", between(0.3, 3));
    v("gusts", self.gusts, "", "wind and gusts");
  }
};

}  // namespace lidarena::flight
