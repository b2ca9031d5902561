// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "lidarena/base/imu_sample.hpp"
#include "lidarena/base/pose.hpp"

namespace lidarena {

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

  Eigen::Vector3d position = Eigen::Vector3d::Zero();            ///< m, of the IMU in the world
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();        ///< world from IMU
  Eigen::Matrix3d lidar_rotation = Eigen::Matrix3d::Identity();  ///< IMU from LiDAR
  Eigen::Vector3d lidar_position = Eigen::Vector3d::Zero();      ///< m, of the LiDAR in the IMU
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();            ///< m/s, world
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();           ///< rad/s
  Eigen::Vector3d accel_bias = Eigen::Vector3d::Zero();          ///< m/s^2
  Eigen::Vector3d gravity{0.0, 0.0, -9.80665};                   ///< m/s^2, world, constant length

  Pose world_from_imu() const { return make_pose(rotation, position); }
  Pose imu_from_lidar() const { return make_pose(lidar_rotation, lidar_position); }
  Pose world_from_lidar() const { return world_from_imu() * imu_from_lidar(); }
};

/// `state` moved by a tangent vector.
InertialState plus(const InertialState& state, const InertialState::Vector& delta);
/// The tangent vector at `b` that leads to `a`: plus(b, minus(a, b)) is a.
InertialState::Vector minus(const InertialState& a, const InertialState& b);

/// Jacobian of the tangent vector at plus(`from`, `delta`) with respect to a small change e of
/// `delta`: minus(plus(from, delta + e), plus(from, delta)) ~ transport(from, delta) e.
InertialState::Matrix transport(const InertialState& from, const InertialState::Vector& delta);

/// Orthonormal basis of the plane perpendicular to `direction`; continuous except where another
/// component of `direction` becomes the smallest.
Eigen::Matrix<double, 3, 2> tangent_basis(const Eigen::Vector3d& direction);

/// Noise of an IMU: continuous-time densities, as on data sheets.
struct ImuNoise {
  double gyro_density = 0.0;   ///< rad/s/sqrt(Hz)
  double accel_density = 0.0;  ///< m/s^2/sqrt(Hz)
  double gyro_walk = 0.0;      ///< rad/s^2/sqrt(Hz)
  double accel_walk = 0.0;     ///< m/s^3/sqrt(Hz)
};

/// How the position is integrated over a step: x + v dt, or x + v dt + a dt^2 / 2.
enum class Integration { kFirstOrder, kSecondOrder };

/// One IMU step of `seconds` with rate and specific force held constant. Changes `state`; returns
/// the Jacobian of the new error with respect to the old one.
InertialState::Matrix propagate(InertialState& state, const Eigen::Vector3d& gyro,
                                const Eigen::Vector3d& accel, double seconds,
                                Integration integration);

/// Covariance that the IMU's noise adds over a step of `seconds`: density^2 * seconds for each
/// part.
InertialState::Matrix step_noise(const ImuNoise& noise, double seconds);

}  // namespace lidarena
