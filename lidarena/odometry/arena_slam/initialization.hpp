// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "lidarena/base/imu_sample.hpp"
#include "lidarena/base/pose.hpp"
#include "lidarena/estimation/inertial_smoother.hpp"
#include "lidarena/odometry/arena_slam/config.hpp"

namespace lidarena::odometry::arena_slam {

/// Result of the initialization.
struct Start {
  estimation::InertialStart inertial;  ///< of the IMU; the body is at the origin with yaw 0
  double accel_scale = 1.0;            ///< factor from the IMU's accelerations to m/s^2
  bool still = false;
};

/// Roll and pitch from the mean specific force; at rest also the gyro's bias from the mean rate and
/// the accelerometer's bias along gravity. Without `gravity_aligned_start`, as in the published
/// program, the body is level and the biases are zero. `samples` must not be empty.
Start start_from(const std::vector<ImuSample>& samples, const Pose& body_from_imu,
                 const Config& config);

}  // namespace lidarena::odometry::arena_slam
