// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <optional>

#include "lidarena/estimation/imu_buffer.hpp"
#include "lidarena/estimation/inertial_prediction.hpp"
#include "lidarena/estimation/inertial_smoother.hpp"
#include "lidarena/odometry/lio_sam/config.hpp"

namespace lidarena::odometry::lio_sam {

/// Poses from the IMU between those of registered scans: preintegration from the latest state of a
/// graph of poses, velocities and biases (section III-B). Registered poses arrive late, because the
/// program lets a scan wait for the two that follow. It is silent until the second pose, and again
/// after a reset, which an implausible velocity or bias causes.
class ImuOdometry {
 public:
  /// `scan_period` (s): time from one scan to the next.
  ImuOdometry(const Config& config, const Pose& imu_from_lidar, double scan_period);

  void register_imu(const ImuSample& sample) { samples_.add(sample); }
  /// Whether there have been enough samples before `end` to begin.
  bool is_ready(Time end);
  /// Moves to the stamp of a scan: uses the poses that have arrived by then, and the samples since.
  void advance(Time stamp);
  /// Pose of the LiDAR at the stamp; none while silent.
  std::optional<Pose> odom_from_lidar() const;
  /// Motion of the LiDAR from the latest scan whose pose was sent to the stamp, by all poses sent,
  /// whether they have arrived or not; none while there are not two.
  Pose motion_since_sent() const;
  /// Motion of the IMU from the stamp to `end`. Rates still have their bias.
  estimation::ImuTrack track(Time end);
  /// Sends the pose of the LiDAR registered at the stamp.
  void send(const Pose& odom_from_lidar, bool degenerate);

  double accel_scale() const { return imu_.accel_scale; }
  double longest_gap_s() const { return longest_gap_s_; }
  std::size_t refused() const { return samples_.refused(); }
  std::size_t resets() const { return resets_; }
  std::uint64_t memory_bytes() const { return samples_.memory_bytes(); }

 private:
  /// A registered pose on its way.
  struct Correction {
    Time stamp{0};
    Pose odom_from_imu;
    bool degenerate = false;
  };
  void use(const Correction& correction);
  void start(const Pose& odom_from_imu);
  bool has_failed() const;

  Pose imu_from_lidar_;
  estimation::ImuModel imu_;
  estimation::ImuBuffer samples_;
  bool ready_ = false;

  std::deque<Correction> underway_;
  Time delay_;  ///< from a scan's stamp to the arrival of its pose

  estimation::InertialSmoother smoother_;
  Time smoothed_until_{0};    ///< stamp of the smoother's last state
  int corrections_ = 0;       ///< poses used since the start or the last reset
  estimation::NavState now_;  ///< at `stamp_`
  Time stamp_{0};
  std::size_t resets_ = 0;
  double longest_gap_s_ = 0.0;  ///< in the last scan and before it
};

}  // namespace lidarena::odometry::lio_sam
