// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "lidarena/base/pose.hpp"

namespace lidarena::estimation {

/// Biases of an IMU: slowly changing offsets of its samples.
struct ImuBias {
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();   ///< rad/s
  Eigen::Vector3d accel = Eigen::Vector3d::Zero();  ///< m/s^2
};

/// Motion of an IMU at an instant, and its biases. World frame: any. Errors are vectors in its
/// tangent space of 15 dimensions, with the rotation perturbed on the right.
struct NavState {
  static constexpr int kDof = 15;
  enum Block { kRotation = 0, kVelocity = 3, kPosition = 6, kGyroBias = 9, kAccelBias = 12 };
  using Vector = Eigen::Matrix<double, kDof, 1>;
  using Matrix = Eigen::Matrix<double, kDof, kDof>;

  Pose world_from_imu = Pose::Identity();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< m/s, world
  ImuBias bias;
};
NavState plus(const NavState& state, const NavState::Vector& delta);
/// The tangent vector at `b` that leads to `a`: plus(b, minus(a, b)) is a.
NavState::Vector minus(const NavState& a, const NavState& b);

}  // namespace lidarena::estimation
