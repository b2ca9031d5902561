// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "lidarena/base/pose.hpp"
#include "lidarena/estimation/imu_noise.hpp"
#include "lidarena/estimation/nav_state.hpp"

namespace lidarena {

/// Motion between two instants as the IMU alone feels it, in its frame at the first one: no
/// gravity, no velocity to begin with.
struct RelativeMotion {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< m/s
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< m
};

/// How well two states fit what the IMU felt between them, and how that follows from their errors.
struct InertialResidual {
  NavState::Vector value;
  NavState::Matrix by_first, by_second;
  /// By the world's gravity vector.
  Eigen::Matrix<double, NavState::kDof, 3> by_gravity;
};

/// IMU samples between two instants summed up once, so that states at both can be estimated without
/// going through the samples again: Forster, Carlone, Dellaert, Scaramuzza, "On-Manifold
/// Preintegration for Real-Time Visual-Inertial Odometry" (IEEE T-RO 2017). Here each step takes
/// its force in the middle of its turn, which makes it exact to second order.
class Preintegration {
 public:
  /// `bias` is taken off all samples; small changes of it are followed to first order.
  Preintegration(const ImuBias& bias, const ImuNoise& noise) : bias_(bias), noise_(noise) {}

  /// One step of `seconds` with rate (rad/s) and specific force (m/s^2) held constant.
  void integrate(const Eigen::Vector3d& gyro, const Eigen::Vector3d& accel, double seconds);
  /// The same, with other noise than the usual (a gap).
  void integrate(const Eigen::Vector3d& gyro, const Eigen::Vector3d& accel, double seconds,
                 const ImuNoise& noise);

  double seconds() const { return seconds_; }
  /// The motion, were the bias this one (T-RO eq. 44).
  RelativeMotion motion(const ImuBias& bias) const;
  /// Where a body that was in state `first` is at the end; its biases stay.
  NavState predict(const NavState& first, const Eigen::Vector3d& gravity) const;
  /// Residuals of T-RO eq. 45, and those of the biases, which should stay. Order: NavState::Block.
  InertialResidual residual(const NavState& first, const NavState& second,
                            const Eigen::Vector3d& gravity) const;
  /// Of residual(), for white noise and walks of the biases.
  const NavState::Matrix& covariance() const { return covariance_; }

 private:
  ImuBias bias_;
  ImuNoise noise_;
  double seconds_ = 0.0;
  RelativeMotion motion_;
  NavState::Matrix covariance_ = NavState::Matrix::Zero();
  /// Of (rotation, velocity, position) by (gyro bias, accel bias).
  Eigen::Matrix<double, 9, 6> by_bias_ = Eigen::Matrix<double, 9, 6>::Zero();
};

}  // namespace lidarena
