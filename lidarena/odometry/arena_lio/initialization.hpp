// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "lidarena/base/imu_sample.hpp"
#include "lidarena/estimation/imu_at_rest.hpp"
#include "lidarena/estimation/imu_buffer.hpp"
#include "lidarena/estimation/imu_track.hpp"
#include "lidarena/estimation/iterated_update.hpp"

namespace lidarena::odometry::arena_lio {

/// Result of the initialization.
struct Initialization {
  estimation::StateEstimate estimate;
  double accel_scale = 1.0;  ///< factor from the IMU's accelerations to m/s^2
  bool still = false;
};

/// Gravity from the direction of the mean specific force; at rest the gyro's bias from the mean
/// rate, and the part of the accelerometer's bias along gravity from the magnitude of the mean
/// force. Velocity and biases of a moving sensor are unknown, and their covariance is large. The
/// world is the IMU's frame. Nothing if there are too few samples or they show no acceleration.
std::optional<Initialization> start_from(const std::vector<ImuSample>& samples,
                                         const Pose& imu_from_lidar);

/// The motion through the intervals that ends in `state`, by the IMU backwards. `accel_scale`:
/// factor to m/s^2.
estimation::ImuTrack track_before(const std::vector<estimation::ImuInterval>& intervals,
                                  const estimation::InertialState& state, double accel_scale);

/// The state `first`, which is before the intervals, with the velocity, gravity and biases that
/// follow from the state `last` after them by the IMU. `accel_scale`: factor to m/s^2.
estimation::InertialState carried_back(const estimation::InertialState& last,
                                       const std::vector<estimation::ImuInterval>& intervals,
                                       estimation::InertialState first, double accel_scale);

/// Decides at each scan whether the sensor stands still. Slow motion is detected by the distance
/// from the place where the standstill began.
class StillDetector {
 public:
  /// `predicted`: the state before the scan's update (with a map of few scans the update turns
  /// its own errors into velocity); `position`: after the update, m.
  bool observe(const estimation::ImuStatistics& imu, const estimation::InertialState& predicted,
               const Eigen::Vector3d& position, double accel_scale);
  int scans() const { return scans_; }  ///< number of scans in the current standstill

 private:
  Eigen::Vector3d anchor_ = Eigen::Vector3d::Zero();
  int scans_ = 0;
};

}  // namespace lidarena::odometry::arena_lio
