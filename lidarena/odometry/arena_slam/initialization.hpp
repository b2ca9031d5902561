// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "lidarena/base/imu_sample.hpp"
#include "lidarena/base/pose.hpp"
#include "lidarena/estimation/inertial_smoother.hpp"

namespace lidarena::odometry::arena_slam {

/// Sigma of gravity's direction in the world after a start at rest, rad.
inline constexpr double kGravitySigma = 0.02;

/// Result of the initialization.
struct Start {
  estimation::InertialStart inertial;  ///< of the IMU; the body is at the origin with yaw 0
  double accel_scale = 1.0;            ///< factor from the IMU's accelerations to m/s^2
  bool still = false;
};

/// Roll and pitch from the mean specific force; at rest also the gyro's bias from the mean rate and
/// the accelerometer's bias along gravity. `samples` must not be empty; `gravity` in m/s^2.
Start start_from(const std::vector<ImuSample>& samples, const Pose& body_from_imu, double gravity);

}  // namespace lidarena::odometry::arena_slam
