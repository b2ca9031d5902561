// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "lidarena/base/pose.hpp"
#include "lidarena/estimation/imu_noise.hpp"
#include "lidarena/estimation/nav_state.hpp"

namespace lidarena::estimation {

/// Motion between two instants as measured by the IMU alone, in its frame at the first one: without
/// gravity and without initial velocity.
struct RelativeMotion {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< m/s
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< m
};

/// Residual of two states given the IMU samples between them, and its Jacobians with respect to
/// their errors.
struct InertialResidual {
  NavState::Vector value;
  NavState::Matrix by_first, by_second;
};

/// IMU samples between two instants, summed up once, so that the states at both can be estimated
/// without processing the samples again: Forster, Carlone, Dellaert, Scaramuzza, "On-Manifold
/// Preintegration for Real-Time Visual-Inertial Odometry" (IEEE T-RO 2017). Here each step applies
/// its force with the rotation at its middle, which makes it exact to second order.
class Preintegration {
 public:
  /// `bias` is subtracted from all samples; later small changes of it are corrected to first order.
  Preintegration(const ImuBias& bias, const ImuNoise& noise) : bias_(bias), noise_(noise) {}

  /// One step of `seconds` with rate (rad/s) and specific force (m/s^2) held constant.
  void integrate(const Eigen::Vector3d& gyro, const Eigen::Vector3d& accel, double seconds);
  /// The same with another noise, for a gap between samples.
  void integrate(const Eigen::Vector3d& gyro, const Eigen::Vector3d& accel, double seconds,
                 const ImuNoise& noise);

  double seconds() const { return seconds_; }
  /// The motion corrected for `bias` (T-RO eq. 44).
  RelativeMotion motion(const ImuBias& bias) const;
  /// The state at the end of a body with state `first` at the start; biases stay the same.
  NavState predict(const NavState& first, const Eigen::Vector3d& gravity) const;
  /// Residuals of T-RO eq. 45, and those of the biases, whose change should be zero. Order:
  /// NavState::Block.
  InertialResidual residual(const NavState& first, const NavState& second,
                            const Eigen::Vector3d& gravity) const;
  /// Covariance of residual(), from white noise and random walks of the biases.
  const NavState::Matrix& covariance() const { return covariance_; }

 private:
  ImuBias bias_;
  ImuNoise noise_;
  double seconds_ = 0.0;
  RelativeMotion motion_;
  NavState::Matrix covariance_ = NavState::Matrix::Zero();
  /// Jacobian of (rotation, velocity, position) with respect to (gyro bias, accel bias).
  Eigen::Matrix<double, 9, 6> by_bias_ = Eigen::Matrix<double, 9, 6>::Zero();
};

}  // namespace lidarena::estimation
