// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "lidarena/base/imu_sample.hpp"
#include "lidarena/base/pose.hpp"
#include "lidarena/estimation/imu_noise.hpp"
#include "lidarena/estimation/nav_state.hpp"

namespace lidarena::estimation {

/// Motion of an IMU, its biases, gravity, and the pose of the LiDAR on it: the state of
/// LiDAR-inertial filters (Xu, Cai, He, Lin, Zhang, "FAST-LIO2", IEEE T-RO 2022, section IV). World
/// frame: any. Errors are vectors in its tangent space of 23 dimensions, with rotations perturbed
/// on the right.
struct InertialState {
  static constexpr int kDof = 23;
  /// Index at which each part's error begins in a tangent vector. The first 12 elements are those
  /// that a LiDAR point depends on.
  enum Block {
    kPosition = 0,
    kRotation = 3,
    kLidarRotation = 6,
    kLidarPosition = 9,
    kVelocity = 12,
    kGyroBias = 15,
    kAccelBias = 18,
    kGravity = 21
  };
  using Vector = Eigen::Matrix<double, kDof, 1>;
  using Matrix = Eigen::Matrix<double, kDof, kDof>;

  NavState nav;                                 ///< of the IMU
  Pose imu_from_lidar = Pose::Identity();       ///< extrinsics
  Eigen::Vector3d gravity{0.0, 0.0, -9.80665};  ///< m/s^2, world, constant length

  const Pose& world_from_imu() const { return nav.world_from_imu; }
  Pose world_from_lidar() const { return nav.world_from_imu * imu_from_lidar; }
  auto position() { return nav.world_from_imu.translation(); }
  auto position() const { return nav.world_from_imu.translation(); }
  auto rotation() { return nav.world_from_imu.linear(); }
  auto rotation() const { return nav.world_from_imu.linear(); }
};

/// `state` moved by a tangent vector.
InertialState plus(const InertialState& state, const InertialState::Vector& delta);
/// The tangent vector at `b` that leads to `a`: plus(b, minus(a, b)) is a.
InertialState::Vector minus(const InertialState& a, const InertialState& b);

/// False if the pose is not finite or the speed is beyond kMaxPlausibleSpeed: it has diverged.
bool is_plausible(const InertialState& state);

/// Jacobian of the tangent vector at plus(`from`, `delta`) with respect to a small change e of
/// `delta`: minus(plus(from, delta + e), plus(from, delta)) ~ transport(from, delta) e.
InertialState::Matrix transport(const InertialState& from, const InertialState::Vector& delta);

/// Orthonormal basis of the plane perpendicular to `direction`; continuous except where another
/// component of `direction` becomes the smallest.
Eigen::Matrix<double, 3, 2> tangent_basis(const Eigen::Vector3d& direction);

/// How a step is integrated: x + v dt, with the specific force turned by the rotation at the step's
/// begin; or x + v dt + a dt^2 / 2, with the rotation in the middle of the step.
enum class Integration { kFirstOrder, kSecondOrder };

/// The rotation that turns the specific force of a step of `seconds` into the world.
Eigen::Matrix3d rotation_in_step(const InertialState& state, const Eigen::Vector3d& gyro,
                                 double seconds, Integration integration);

/// One IMU step of `seconds` with rate and specific force held constant. Changes `state`; returns
/// the Jacobian of the new error with respect to the old one.
InertialState::Matrix propagate(InertialState& state, const Eigen::Vector3d& gyro,
                                const Eigen::Vector3d& accel, double seconds,
                                Integration integration);

/// Covariance that the IMU's noise adds over a step of `seconds`: density^2 * seconds for each
/// part.
InertialState::Matrix step_noise(const ImuNoise& noise, double seconds);

}  // namespace lidarena::estimation
