// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "lidarena/base/imu_sample.hpp"
#include "lidarena/base/pose.hpp"
#include "lidarena/base/time.hpp"

namespace lidarena::flight {

/// Magnitude of gravity, m/s^2; it points along -z of the world.
inline constexpr double kGravity = 9.80665;

/// State of the flying body at one instant.
struct Motion {
  Pose world_from_body = Pose::Identity();
  Eigen::Vector3d velocity_world = Eigen::Vector3d::Zero();             ///< m/s
  Eigen::Vector3d acceleration_world = Eigen::Vector3d::Zero();         ///< m/s^2, without gravity
  Eigen::Vector3d angular_rate_body = Eigen::Vector3d::Zero();          ///< rad/s
  Eigen::Vector3d angular_acceleration_body = Eigen::Vector3d::Zero();  ///< rad/s^2 (lever arms)
};

/// Samples of a real IMU that was on the flight.
struct RecordedImu {
  std::vector<ImuSample> samples;  ///< stamps since the start of the flight, strictly increasing
  Pose body_from_imu = Pose::Identity();
};

/// A flight as a pure, continuous function of time, which LiDAR, IMU and ground truth sample at
/// their own instants. Defined on [0, duration()]; outside, the body rests at its first or last
/// pose. Body frame: x forward, y left, z up.
class Flight {
 public:
  virtual ~Flight() = default;
  virtual Motion at(Time t) const = 0;
  virtual Time duration() const = 0;
  /// The pose only, for ray casting; may be cheaper than at().
  virtual Pose pose_at(Time t) const { return at(t).world_from_body; }
  /// What a real IMU measured on this flight; null where IMUs are simulated.
  virtual const RecordedImu* recorded_imu() const { return nullptr; }
};

}  // namespace lidarena::flight
