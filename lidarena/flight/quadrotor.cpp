// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/quadrotor.hpp"

#include <algorithm>
#include <cmath>

#include "lidarena/flight/flight.hpp"

namespace lidarena::flight {

using Eigen::Array4d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

// For the rotors front left, front right, rear left, rear right: sign of the position in x and y,
// and sign of the reaction torque about z.
const Array4d kAhead{1, 1, -1, -1};
const Array4d kLeft{1, -1, 1, -1};
const Array4d kSpin{1, -1, -1, 1};

}  // namespace

Quadrotor::Quadrotor(const DynamicsConfig& config)
    : config_(config), lever_(config.arm_m / std::sqrt(2.0)) {}

Wrench Quadrotor::wrench(const Array4d& rotor_speed) const {
  const Array4d thrust = config_.max_thrust * rotor_speed.square();
  return {thrust.sum(),
          {lever_ * (kLeft * thrust).sum(), -lever_ * (kAhead * thrust).sum(),
           config_.torque_per_thrust * (kSpin * thrust).sum()}};
}

Array4d Quadrotor::speeds_for(const Wrench& wanted) const {
  const Array4d level = 0.25 * wanted.thrust +
                        0.25 / lever_ * (wanted.torque.x() * kLeft - wanted.torque.y() * kAhead);
  const double room =
      std::max(0.0, std::min(level.minCoeff(), config_.max_thrust - level.maxCoeff()));
  const double turn = std::clamp(0.25 / config_.torque_per_thrust * wanted.torque.z(), -room, room);
  return ((level + turn * kSpin) / config_.max_thrust).max(0.0).min(1.0).sqrt();
}

Vector3d Quadrotor::drag(const Matrix3d& world_from_body, const Vector3d& velocity) const {
  const Vector3d z = world_from_body.col(2);
  return -config_.mass_kg * config_.drag_per_s * (velocity - z.dot(velocity) * z);
}

QuadrotorRate Quadrotor::derivative(const QuadrotorState& s, const Array4d& command,
                                    const Vector3d& air) const {
  const Wrench w = wrench(s.rotor_speed);
  const Matrix3d r = s.attitude.normalized().toRotationMatrix();
  const Vector3d force = w.thrust * r.col(2) + drag(r, s.velocity - air);
  const Eigen::Quaterniond turning(0.0, s.rate.x(), s.rate.y(), s.rate.z());
  const Vector3d momentum = config_.inertia.cwiseProduct(s.rate);
  return {.position = s.velocity,
          .velocity = force / config_.mass_kg - kGravity * Vector3d::UnitZ(),
          .attitude = 0.5 * (s.attitude * turning).coeffs(),
          .rate = (w.torque - s.rate.cross(momentum)).cwiseQuotient(config_.inertia),
          .rotor_speed = (command - s.rotor_speed) / config_.motor_lag_s};
}

QuadrotorState advanced(const QuadrotorState& s, const QuadrotorRate& rate, double h) {
  QuadrotorState next = s;
  next.position += h * rate.position;
  next.velocity += h * rate.velocity;
  next.attitude.coeffs() += h * rate.attitude;
  next.rate += h * rate.rate;
  next.rotor_speed += h * rate.rotor_speed;
  return next;
}

}  // namespace lidarena::flight
