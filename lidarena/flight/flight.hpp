// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "lidarena/base/pose.hpp"
#include "lidarena/base/time.hpp"

namespace lidarena {

/// Magnitude of gravity, m/s^2; it points along -z of the world. The one place it is written.
inline constexpr double kGravity = 9.80665;

/// State of the flying body at one instant.
struct Motion {
  Pose world_from_body = Pose::Identity();
  Eigen::Vector3d velocity_world = Eigen::Vector3d::Zero();             ///< m/s
  Eigen::Vector3d acceleration_world = Eigen::Vector3d::Zero();         ///< m/s^2, without gravity
  Eigen::Vector3d angular_rate_body = Eigen::Vector3d::Zero();          ///< rad/s
  Eigen::Vector3d angular_acceleration_body = Eigen::Vector3d::Zero();  ///< rad/s^2 (lever arms)
};

/// A flight: continuous in time and pure, so LiDAR, IMU and truth sample one function, each at its
/// own instants. Defined on [0, duration()]; outside, the body rests where it began or ended.
/// Body frame: x forward, y left, z up.
class Flight {
 public:
  virtual ~Flight() = default;
  virtual Motion at(Time t) const = 0;
  virtual Time duration() const = 0;
  /// The pose alone, for ray casting; cheaper than at() where that matters.
  virtual Pose pose_at(Time t) const { return at(t).world_from_body; }
};

}  // namespace lidarena
