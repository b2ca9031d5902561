// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "lidarena/base/imu_sample.hpp"

/// What an IMU at rest tells an odometry at its start (leveling: P. D. Groves, "Principles of
/// GNSS, Inertial, and Multisensor Integrated Navigation Systems", 2nd ed., 2013, section 5.6; that
/// a LiDAR-inertial odometry begins so: W. Xu, F. Zhang, "FAST-LIO", IEEE RA-L 2021). The mean rate
/// is the gyro's bias; the mean specific force points up.
namespace lidarena {

/// Mean and spread of some samples, in the IMU's frame.
struct ImuStatistics {
  std::size_t count = 0;
  Eigen::Vector3d mean_gyro = Eigen::Vector3d::Zero();   ///< rad/s
  Eigen::Vector3d mean_accel = Eigen::Vector3d::Zero();  ///< m/s^2, or in units of g
  double gyro_sigma = 0.0;   ///< rad/s, root of the mean square over three axes
  double accel_sigma = 0.0;  ///< likewise, in the unit of the accelerations
};
/// Zeros without samples.
ImuStatistics statistics(const std::vector<ImuSample>& samples);

/// What brings the accelerations to m/s^2: `gravity` (m/s^2) if by their size they are in units of
/// g, as Livox's drivers give them, else 1.
double accel_scale_of(const ImuStatistics& imu, double gravity);

/// Whether the samples, three or more, show a sensor that stands: no spread beyond a quiet
/// vehicle's, no turning beyond a gyro's first bias, and a force as long as `gravity` (m/s^2). A
/// steady push across gravity, which hardly makes the force longer, is not seen.
bool stands(const ImuStatistics& imu, double gravity, double accel_scale);

/// Of the accelerometer's bias at rest the part along gravity (m/s^2, IMU frame): what the mean
/// force is longer than `gravity` by. The part across looks like a lean.
Eigen::Vector3d accel_bias_along(const ImuStatistics& imu, double gravity, double accel_scale);

/// The rotation without yaw that turns `up`, a direction of the body of any length, to z.
Eigen::Matrix3d upright(const Eigen::Vector3d& up);

}  // namespace lidarena
