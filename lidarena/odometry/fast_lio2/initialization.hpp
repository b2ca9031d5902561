// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "lidarena/base/imu_sample.hpp"
#include "lidarena/estimation/imu_at_rest.hpp"
#include "lidarena/estimation/iterated_update.hpp"
#include "lidarena/odometry/fast_lio2/config.hpp"

namespace lidarena::fast_lio2 {

/// What the start says.
struct Start {
  Belief belief;
  double accel_scale = 1.0;  ///< brings the IMU's accelerations to m/s^2
  bool still = false;
};

/// Gravity from the mean specific force, gyro bias from the mean rate, at rest also the part of the
/// accelerometer's bias that lies along gravity, from the mean force's length; the world is the
/// IMU's frame (FAST-LIO2 supposes a sensor at rest; with `initial_sigma` 0, one that moves is
/// given a velocity and a gyro bias that are unknown).
Start start_from(const std::vector<ImuSample>& samples, const Pose& imu_from_lidar,
                 const Config& config);

/// Whether the sensor stands still, from one scan to the next. Slow motion is told by the distance
/// that it adds up to.
class StillDetector {
 public:
  /// `predicted`: the state before the scan's update, which takes its own error for motion while
  /// the map is young; `position`: after it, m.
  bool observe(const ImuStatistics& imu, const InertialState& predicted,
               const Eigen::Vector3d& position, const Config& config, double accel_scale);
  int scans() const { return scans_; }  ///< that it has stood for

 private:
  Eigen::Vector3d anchor_ = Eigen::Vector3d::Zero();
  int scans_ = 0;
};

}  // namespace lidarena::fast_lio2
