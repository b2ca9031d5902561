// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "lidarena/flight/quadrotor_config.hpp"

namespace lidarena::flight {

/// State of a quadrotor. Body frame: x forward, y left, z up, at the center of mass. Rotors: front
/// left, front right, rear left, rear right.
struct QuadrotorState {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();            ///< m, world
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();            ///< m/s, world
  Eigen::Quaterniond attitude = Eigen::Quaterniond::Identity();  ///< world_from_body
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();                ///< rad/s, body
  Eigen::Array4d rotor_speed = Eigen::Array4d::Zero();           ///< as a fraction of full speed
};

/// Time derivative of a QuadrotorState.
struct QuadrotorRate {
  Eigen::Vector3d position, velocity;
  Eigen::Vector4d attitude;  ///< of the quaternion's coefficients x, y, z, w
  Eigen::Vector3d rate;
  Eigen::Array4d rotor_speed;
};

/// Thrust along the body's z axis and torque about the body's axes.
struct Wrench {
  double thrust = 0.0;                               ///< N
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();  ///< N m
};

/// Physical model: a rigid body, four rotors whose speed follows its command with a first-order lag
/// and whose thrust and torque are proportional to the square of the speed, gravity, and drag
/// proportional to the airspeed perpendicular to the thrust (rotor drag).
class Quadrotor {
 public:
  explicit Quadrotor(const DynamicsConfig& config);

  /// `command`: commanded rotor speeds as fractions of full speed, in [0, 1]; `air`: velocity of
  /// the air, m/s, world.
  QuadrotorRate derivative(const QuadrotorState& state, const Eigen::Array4d& command,
                           const Eigen::Vector3d& air) const;
  /// The wrench of the rotors at these speeds (as fractions of full speed).
  Wrench wrench(const Eigen::Array4d& rotor_speed) const;
  /// Rotor speeds that produce the wrench `wanted` as far as possible: the torque about z is
  /// reduced first, then each rotor is limited to the range from standstill to full speed.
  Eigen::Array4d speeds_for(const Wrench& wanted) const;
  /// Drag force on the body, N, world.
  Eigen::Vector3d drag(const Eigen::Matrix3d& world_from_body,
                       const Eigen::Vector3d& velocity_through_air) const;
  const DynamicsConfig& config() const { return config_; }

 private:
  DynamicsConfig config_;
  double lever_;  ///< m, lever arm of a rotor about the x and the y axis
};

/// Returns state + h * rate; the quaternion is not normalized.
QuadrotorState advanced(const QuadrotorState& state, const QuadrotorRate& rate, double h);

/// One step of the classical Runge-Kutta method of order 4 over h seconds from `t`.
/// `derivative(t, state)` gives a QuadrotorRate.
template <class Derivative>
QuadrotorState runge_kutta(const QuadrotorState& state, double t, double h,
                           const Derivative& derivative) {
  const QuadrotorRate k1 = derivative(t, state);
  const QuadrotorRate k2 = derivative(t + 0.5 * h, advanced(state, k1, 0.5 * h));
  const QuadrotorRate k3 = derivative(t + 0.5 * h, advanced(state, k2, 0.5 * h));
  const QuadrotorRate k4 = derivative(t + h, advanced(state, k3, h));
  QuadrotorState next = advanced(state, k1, h / 6.0);
  next = advanced(next, k2, h / 3.0);
  next = advanced(next, k3, h / 3.0);
  next = advanced(next, k4, h / 6.0);
  next.attitude.normalize();
  return next;
}

}  // namespace lidarena::flight
