// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "lidarena/estimation/imu_buffer.hpp"
#include "lidarena/estimation/inertial_prediction.hpp"
#include "lidarena/estimation/inertial_smoother.hpp"
#include "lidarena/odometry/lio_sam/config.hpp"

namespace lidarena::odometry::lio_sam {

/// Poses from the IMU between those of registered scans: preintegration from the latest state of a
/// graph of poses, velocities and biases (section III-B). It is silent until the second pose, and
/// again after a reset, which an implausible velocity or bias causes.
class ImuOdometry {
 public:
  ImuOdometry(const Config& config, const Pose& imu_from_lidar);

  void register_imu(const ImuSample& sample) { samples_.add(sample); }
  /// Whether there have been enough samples before `end` to begin.
  bool is_ready(Time end);
  /// Integrates the samples up to `stamp`.
  void advance(Time stamp);
  /// Pose of the LiDAR at the latest instant of advance() or correct(); none while it is silent.
  std::optional<Pose> odom_from_lidar() const;
  /// Motion of the IMU from the latest instant of advance() to `end`. Rates still have their bias.
  estimation::ImuTrack track(Time end);
  /// Adds the pose of the LiDAR registered at the latest instant of advance().
  void correct(const Pose& odom_from_lidar, bool degenerate);

  double accel_scale() const { return imu_.accel_scale; }
  double longest_gap_s() const { return longest_gap_s_; }
  std::size_t refused() const { return samples_.refused(); }
  std::size_t resets() const { return resets_; }
  std::uint64_t memory_bytes() const { return samples_.memory_bytes(); }

 private:
  void restart(const Pose& odom_from_imu);
  bool has_failed() const;

  Pose imu_from_lidar_;
  estimation::ImuModel imu_;
  estimation::ImuBuffer samples_;
  bool ready_ = false;

  estimation::InertialSmoother smoother_;
  estimation::Preintegration pending_;  ///< since the smoother's last state
  estimation::NavState now_;            ///< at `stamp_`
  Time stamp_{0};
  int corrections_ = 0;  ///< poses since the start or the last reset
  std::size_t resets_ = 0;
  double longest_gap_s_ = 0.0;  ///< in the last scan and before it
};

}  // namespace lidarena::odometry::lio_sam
