// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/inertial_state.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "lidarena/base/so3.hpp"

namespace lidarena::estimation {
namespace {

using State = InertialState;

template <int Size = 3>
auto part(const State::Vector& v, State::Block block) {
  return v.segment<Size>(block);
}

/// The rotation vector, perpendicular to `b`, that rotates the direction of `b` to that of `a`.
Eigen::Vector3d rotation_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d across = b.cross(a);
  const double sine = across.norm();
  const double angle = std::atan2(sine, a.dot(b));
  if (sine > 0.0) return angle / sine * across;
  if (angle < 1.0) return Eigen::Vector3d::Zero();
  return angle * tangent_basis(b).col(0);  // opposite: any perpendicular axis
}

}  // namespace

Eigen::Matrix<double, 3, 2> tangent_basis(const Eigen::Vector3d& direction) {
  const Eigen::Vector3d unit = direction.normalized();
  Eigen::Index smallest = 0;
  unit.cwiseAbs().minCoeff(&smallest);
  Eigen::Matrix<double, 3, 2> basis;
  basis.col(0) = unit.cross(Eigen::Vector3d::Unit(smallest)).normalized();
  basis.col(1) = unit.cross(basis.col(0));
  return basis;
}

State plus(const State& state, const State::Vector& delta) {
  State moved = state;
  moved.position() += part(delta, State::kPosition);
  moved.rotation() *= so3::exp(part(delta, State::kRotation));
  moved.imu_from_lidar.linear() *= so3::exp(part(delta, State::kLidarRotation));
  moved.imu_from_lidar.translation() += part(delta, State::kLidarPosition);
  moved.nav.velocity += part(delta, State::kVelocity);
  moved.nav.bias.gyro += part(delta, State::kGyroBias);
  moved.nav.bias.accel += part(delta, State::kAccelBias);
  const Eigen::Vector3d turn = tangent_basis(state.gravity) * part<2>(delta, State::kGravity);
  moved.gravity = so3::exp(turn) * state.gravity;
  return moved;
}

State::Vector minus(const State& a, const State& b) {
  State::Vector delta;
  delta << a.position() - b.position(), so3::log(b.rotation().transpose() * a.rotation()),
      so3::log(b.imu_from_lidar.linear().transpose() * a.imu_from_lidar.linear()),
      a.imu_from_lidar.translation() - b.imu_from_lidar.translation(),
      a.nav.velocity - b.nav.velocity, a.nav.bias.gyro - b.nav.bias.gyro,
      a.nav.bias.accel - b.nav.bias.accel,
      tangent_basis(b.gravity).transpose() * rotation_between(a.gravity, b.gravity);
  return delta;
}

bool is_plausible(const State& state) {
  return state.position().allFinite() && state.rotation().allFinite() &&
         state.nav.velocity.norm() < kMaxPlausibleSpeed;
}

State::Matrix transport(const State& from, const State::Vector& delta) {
  State::Matrix a = State::Matrix::Identity();
  for (const State::Block block : {State::kRotation, State::kLidarRotation}) {
    a.block<3, 3>(block, block) = so3::right_jacobian(part(delta, block));
  }
  // exp(B (d + e)) g is exp(left_jacobian(B d) B e) applied to the rotated gravity, and the part of
  // that rotation about the rotated gravity has no effect.
  const Eigen::Matrix<double, 3, 2> basis = tangent_basis(from.gravity);
  const Eigen::Vector3d turn = basis * part<2>(delta, State::kGravity);
  const Eigen::Vector3d moved = so3::exp(turn) * from.gravity;
  a.block<2, 2>(State::kGravity, State::kGravity) =
      tangent_basis(moved).transpose() * so3::left_jacobian(turn) * basis;
  return a;
}

Eigen::Matrix3d rotation_in_step(const State& state, const Eigen::Vector3d& gyro, double seconds,
                                 Integration integration) {
  if (integration == Integration::kFirstOrder) return state.rotation();
  return state.rotation() * so3::exp(0.5 * seconds * (gyro - state.nav.bias.gyro));
}

State::Matrix propagate(State& state, const Eigen::Vector3d& gyro, const Eigen::Vector3d& accel,
                        double seconds, Integration integration) {
  const Eigen::Vector3d turn = (gyro - state.nav.bias.gyro) * seconds;
  const Eigen::Vector3d force = accel - state.nav.bias.accel;
  const bool second_order = integration == Integration::kSecondOrder;
  const double half = second_order ? 0.5 * seconds : 0.0;
  const Eigen::Matrix3d rotation = rotation_in_step(state, gyro, seconds, integration);
  const Eigen::Vector3d acceleration = rotation * force + state.gravity;

  State::Matrix f = State::Matrix::Identity();
  const Eigen::Vector3d force_at_begin = state.rotation().transpose() * rotation * force;
  const Eigen::Matrix3d by_rotation = -state.rotation() * so3::hat(force_at_begin) * seconds;
  const Eigen::Matrix3d by_bias = -rotation * seconds;
  // The rotation in the step depends on the rate until then.
  const Eigen::Matrix3d by_gyro_bias =
      rotation * so3::hat(force) * so3::right_jacobian(0.5 * turn) * half * seconds;
  const Eigen::Matrix<double, 3, 2> by_gravity =
      -so3::hat(state.gravity) * tangent_basis(state.gravity) * seconds;
  f.block<3, 3>(State::kPosition, State::kVelocity).diagonal().setConstant(seconds);
  f.block<3, 3>(State::kPosition, State::kRotation) = half * by_rotation;
  f.block<3, 3>(State::kPosition, State::kGyroBias) = half * by_gyro_bias;
  f.block<3, 3>(State::kPosition, State::kAccelBias) = half * by_bias;
  f.block<3, 2>(State::kPosition, State::kGravity) = half * by_gravity;
  f.block<3, 3>(State::kRotation, State::kRotation) = so3::exp(-turn);
  f.block<3, 3>(State::kRotation, State::kGyroBias) = -so3::right_jacobian(turn) * seconds;
  f.block<3, 3>(State::kVelocity, State::kRotation) = by_rotation;
  f.block<3, 3>(State::kVelocity, State::kGyroBias) = by_gyro_bias;
  f.block<3, 3>(State::kVelocity, State::kAccelBias) = by_bias;
  f.block<3, 2>(State::kVelocity, State::kGravity) = by_gravity;

  state.position() += (state.nav.velocity + half * acceleration) * seconds;
  state.nav.velocity += acceleration * seconds;
  state.rotation() *= so3::exp(turn);
  return f;
}

State::Matrix step_noise(const ImuNoise& noise, double seconds) {
  // The same variance on each axis, so rotating it changes nothing.
  State::Vector variances = State::Vector::Zero();
  const auto set = [&](State::Block block, double density) {
    variances.segment<3>(block).setConstant(density * density * seconds);
  };
  set(State::kRotation, noise.gyro_density);
  set(State::kVelocity, noise.accel_density);
  set(State::kGyroBias, noise.gyro_bias_walk);
  set(State::kAccelBias, noise.accel_bias_walk);
  return variances.asDiagonal();
}

}  // namespace lidarena::estimation
