// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/geometric_controller.hpp"

#include <algorithm>
#include <cmath>

#include "lidarena/base/so3.hpp"

namespace lidarena::flight {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Upper limit on the acceleration that corrects errors, m/s^2: half of gravity, so that the thrust
/// never points downward.
constexpr double kMaxCorrection = 0.5 * kGravity;

Vector3d desired_force(const Quadrotor& quadrotor, const QuadrotorState& state,
                       const Motion& reference) {
  const DynamicsConfig& c = quadrotor.config();
  const double w = c.position_bandwidth;
  Vector3d correction = w * w * (reference.world_from_body.translation() - state.position) +
                        2.0 * c.damping * w * (reference.velocity_world - state.velocity);
  correction *= std::min(1.0, kMaxCorrection / std::max(correction.norm(), 1e-12));
  return c.mass_kg * (reference.acceleration_world + correction + kGravity * Vector3d::UnitZ()) -
         quadrotor.drag(reference.world_from_body.linear(), reference.velocity_world);
}

/// Attitude error as a rotation vector in the body frame: x and y are the shortest rotation that
/// aligns the z axis, z is the remaining heading error. A lag of the heading thus does not affect
/// the tilt.
Vector3d attitude_error(const Matrix3d& body_from_wanted) {
  const Matrix3d tilt =
      Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), body_from_wanted.col(2))
          .toRotationMatrix();
  const Matrix3d rest = tilt.transpose() * body_from_wanted;
  return so3::log(tilt) + std::atan2(rest(1, 0), rest(0, 0)) * Vector3d::UnitZ();
}

}  // namespace

Wrench tracking_wrench(const Quadrotor& quadrotor, const QuadrotorState& state,
                       const Motion& reference) {
  const DynamicsConfig& c = quadrotor.config();
  const Vector3d force = desired_force(quadrotor, state, reference);
  const Matrix3d& of_reference = reference.world_from_body.linear();
  const Matrix3d wanted =
      Eigen::Quaterniond::FromTwoVectors(of_reference.col(2), force) * of_reference;
  const Matrix3d r = state.attitude.normalized().toRotationMatrix();
  const Matrix3d body_from_wanted = r.transpose() * wanted;

  const Vector3d rate = body_from_wanted * reference.angular_rate_body;
  const Vector3d w{c.tilt_bandwidth, c.tilt_bandwidth, c.yaw_bandwidth};
  const Vector3d angular_acceleration =
      w.cwiseAbs2().cwiseProduct(attitude_error(body_from_wanted)) -
      2.0 * c.damping * w.cwiseProduct(state.rate - rate) - state.rate.cross(rate) +
      body_from_wanted * reference.angular_acceleration_body;
  return {std::max(0.0, force.dot(r.col(2))),
          c.inertia.cwiseProduct(angular_acceleration) +
              state.rate.cross(c.inertia.cwiseProduct(state.rate))};
}

}  // namespace lidarena::flight
