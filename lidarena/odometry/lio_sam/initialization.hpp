// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "lidarena/base/imu_sample.hpp"
#include "lidarena/base/pose.hpp"
#include "lidarena/estimation/inertial_smoother.hpp"
#include "lidarena/odometry/lio_sam/config.hpp"

namespace lidarena::lio_sam {

/// What the first samples say.
struct Start {
  InertialStart inertial;    ///< of the IMU; the body is at the origin and looks along x
  double accel_scale = 1.0;  ///< brings the IMU's accelerations to m/s^2
  bool still = false;
};

/// Roll and pitch from the mean specific force and the gyro's bias from the mean rate if the sensor
/// stands; the program (without `level_start`) takes the body to be level, the biases to be zero.
/// `samples` are not empty.
Start start_from(const std::vector<ImuSample>& samples, const Pose& body_from_imu,
                 const Config& config);

}  // namespace lidarena::lio_sam
