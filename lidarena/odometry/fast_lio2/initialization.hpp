// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "lidarena/base/imu_sample.hpp"
#include "lidarena/estimation/iterated_update.hpp"

namespace lidarena::odometry::fast_lio2 {

/// Result of the initialization.
struct Start {
  estimation::StateEstimate estimate;
  double accel_scale = 1.0;  ///< factor on the IMU's accelerations
};

/// Gravity from the direction of the mean specific force, the gyro's bias from the mean rate; the
/// sensor must be at rest. The world is the IMU's frame. All accelerations are scaled so that their
/// mean here is as long as gravity, in whatever unit they are. Nothing if there are too few samples
/// or they show no acceleration.
std::optional<Start> start_from(const std::vector<ImuSample>& samples, const Pose& imu_from_lidar);

}  // namespace lidarena::odometry::fast_lio2
