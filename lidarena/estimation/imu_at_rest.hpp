// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "lidarena/base/imu_sample.hpp"

/// Initialization of an odometry by an IMU at rest (leveling: P. D. Groves, "Principles of GNSS,
/// Inertial, and Multisensor Integrated Navigation Systems", 2nd ed., 2013, section 5.6; as the
/// start of a LiDAR-inertial odometry: W. Xu, F. Zhang, "FAST-LIO", IEEE RA-L 2021). The mean rate
/// is the gyro's bias; the mean specific force points up.
namespace lidarena::estimation {

/// Mean and spread of some samples, in the IMU's frame.
struct ImuStatistics {
  std::size_t count = 0;
  Eigen::Vector3d mean_gyro = Eigen::Vector3d::Zero();   ///< rad/s
  Eigen::Vector3d mean_accel = Eigen::Vector3d::Zero();  ///< m/s^2, or in units of g
  double gyro_sigma = 0.0;   ///< rad/s, root of the mean square over three axes
  double accel_sigma = 0.0;  ///< likewise, in the unit of the accelerations
};
/// All zeros if there are no samples.
ImuStatistics statistics(const std::vector<ImuSample>& samples);

/// Factor that converts the accelerations to m/s^2: `gravity` (m/s^2) if their size shows that they
/// are in units of g, as from Livox's drivers, else 1.
double accel_scale_of(const ImuStatistics& imu, double gravity);

/// Whether the samples, at least three, are of a sensor at rest: a spread within that of a vehicle
/// at rest, a mean rate within a gyro's turn-on bias, and a mean force as long as `gravity`
/// (m/s^2). A constant horizontal acceleration is not detected, because it hardly changes the
/// length of the force.
bool is_at_rest(const ImuStatistics& imu, double gravity, double accel_scale);

/// The accelerometer's bias along gravity at rest (m/s^2, IMU frame): by how much the mean force is
/// longer than `gravity`. The horizontal bias cannot be distinguished from a tilt.
Eigen::Vector3d accel_bias_along_gravity(const ImuStatistics& imu, double gravity,
                                         double accel_scale);

/// The rotation without yaw that maps `up` (body frame, any length) to the direction of z.
Eigen::Matrix3d level_rotation(const Eigen::Vector3d& up);

}  // namespace lidarena::estimation
