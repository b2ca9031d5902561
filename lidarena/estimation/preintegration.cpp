// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/preintegration.hpp"

#include "lidarena/base/so3.hpp"

namespace lidarena::estimation {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Jacobians of the motion after one step with respect to the motion before it and to the rate and
/// force of the step.
struct Step {
  Eigen::Matrix<double, 9, 9> by_motion = Eigen::Matrix<double, 9, 9>::Identity();
  Eigen::Matrix<double, 9, 6> by_input = Eigen::Matrix<double, 9, 6>::Zero();
};

Step advance(RelativeMotion& motion, const Vector3d& rate, const Vector3d& force, double dt) {
  const Vector3d half_turn = 0.5 * dt * rate;
  const Matrix3d middle = motion.rotation * so3::exp(half_turn);
  const Matrix3d push = -middle * so3::hat(force);  // d(rotated force) / d(error of middle)

  Step step;
  step.by_motion.block<3, 3>(0, 0) = so3::exp(-2.0 * half_turn);
  step.by_motion.block<3, 3>(3, 0) = push * so3::exp(-half_turn) * dt;
  step.by_motion.block<3, 3>(6, 0) = 0.5 * dt * step.by_motion.block<3, 3>(3, 0);
  step.by_motion.block<3, 3>(6, 3) = dt * Matrix3d::Identity();
  step.by_input.block<3, 3>(0, 0) = so3::right_jacobian(2.0 * half_turn) * dt;
  step.by_input.block<3, 3>(3, 0) = push * so3::right_jacobian(half_turn) * (0.5 * dt * dt);
  step.by_input.block<3, 3>(3, 3) = middle * dt;
  step.by_input.block<3, 6>(6, 0) = 0.5 * dt * step.by_input.block<3, 6>(3, 0);

  motion.position += motion.velocity * dt + middle * force * (0.5 * dt * dt);
  motion.velocity += middle * force * dt;
  motion.rotation *= so3::exp(2.0 * half_turn);
  return step;
}

}  // namespace

void Preintegration::integrate(const Vector3d& gyro, const Vector3d& accel, double seconds) {
  integrate(gyro, accel, seconds, noise_);
}

void Preintegration::integrate(const Vector3d& gyro, const Vector3d& accel, double seconds,
                               const ImuNoise& noise) {
  const Step step = advance(motion_, gyro - bias_.gyro, accel - bias_.accel, seconds);
  by_bias_ = step.by_motion * by_bias_ - step.by_input;

  const auto variance = [&](double density) { return density * density; };
  Eigen::Matrix<double, 6, 1> input;  // variance of the mean over the step
  input << Vector3d::Constant(variance(noise.gyro_density) / seconds),
      Vector3d::Constant(variance(noise.accel_density) / seconds);
  auto moved = covariance_.topLeftCorner<9, 9>();
  moved = (step.by_motion * moved * step.by_motion.transpose() +
           step.by_input * input.asDiagonal() * step.by_input.transpose())
              .eval();
  covariance_.diagonal().segment<3>(NavState::kGyroBias).array() +=
      variance(noise.gyro_bias_walk) * seconds;
  covariance_.diagonal().segment<3>(NavState::kAccelBias).array() +=
      variance(noise.accel_bias_walk) * seconds;
  seconds_ += seconds;
}

RelativeMotion Preintegration::motion(const ImuBias& bias) const {
  Eigen::Matrix<double, 6, 1> change;
  change << bias.gyro - bias_.gyro, bias.accel - bias_.accel;
  const Eigen::Matrix<double, 9, 1> delta = by_bias_ * change;
  return {motion_.rotation * so3::exp(delta.head<3>()), motion_.velocity + delta.segment<3>(3),
          motion_.position + delta.tail<3>()};
}

NavState Preintegration::predict(const NavState& first, const Vector3d& gravity) const {
  const RelativeMotion measured = motion(first.bias);
  const Matrix3d rotation = first.world_from_imu.linear();
  NavState second = first;
  second.world_from_imu.linear() = rotation * measured.rotation;
  second.velocity += gravity * seconds_ + rotation * measured.velocity;
  second.world_from_imu.translation() += first.velocity * seconds_ +
                                         0.5 * seconds_ * seconds_ * gravity +
                                         rotation * measured.position;
  return second;
}

InertialResidual Preintegration::residual(const NavState& first, const NavState& second,
                                          const Vector3d& gravity) const {
  const RelativeMotion measured = motion(first.bias);
  const Matrix3d back = first.world_from_imu.linear().transpose();  // world to the first IMU frame
  const Matrix3d turned = back * second.world_from_imu.linear();
  const Vector3d speed = back * (second.velocity - first.velocity - gravity * seconds_);
  const Vector3d displacement =
      back * (second.world_from_imu.translation() - first.world_from_imu.translation() -
              first.velocity * seconds_ - 0.5 * seconds_ * seconds_ * gravity);
  const Vector3d turn_error = so3::log(measured.rotation.transpose() * turned);
  const Vector3d bias_turn =
      by_bias_.topRows<3>() * (Eigen::Matrix<double, 6, 1>() << first.bias.gyro - bias_.gyro,
                               first.bias.accel - bias_.accel)
                                  .finished();

  InertialResidual r;
  r.value << turn_error, speed - measured.velocity, displacement - measured.position,
      second.bias.gyro - first.bias.gyro, second.bias.accel - first.bias.accel;
  const Matrix3d by_turn = so3::right_jacobian_inverse(turn_error);
  r.by_first = -NavState::Matrix::Identity();
  r.by_first.block<3, 3>(0, NavState::kRotation) = -by_turn * turned.transpose();
  r.by_first.block<3, 3>(0, NavState::kGyroBias) = -by_turn * so3::exp(-turn_error) *
                                                   so3::right_jacobian(bias_turn) *
                                                   by_bias_.topLeftCorner<3, 3>();
  r.by_first.block<3, 3>(3, NavState::kRotation) = so3::hat(speed);
  r.by_first.block<3, 3>(3, NavState::kVelocity) = -back;
  r.by_first.block<3, 3>(6, NavState::kRotation) = so3::hat(displacement);
  r.by_first.block<3, 3>(6, NavState::kVelocity) = -seconds_ * back;
  r.by_first.block<3, 3>(6, NavState::kPosition) = -back;
  r.by_first.block<6, 6>(3, NavState::kGyroBias) = -by_bias_.bottomRows<6>();
  r.by_second = NavState::Matrix::Identity();
  r.by_second.block<3, 3>(0, NavState::kRotation) = by_turn;
  r.by_second.block<3, 3>(3, NavState::kVelocity) = back;
  r.by_second.block<3, 3>(6, NavState::kPosition) = back;
  return r;
}

}  // namespace lidarena::estimation
