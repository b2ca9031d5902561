// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/rig.hpp"
#include "lidarena/estimation/imu_buffer.hpp"
#include "lidarena/estimation/imu_track.hpp"
#include "lidarena/estimation/inertial_prediction.hpp"
#include "lidarena/estimation/inertial_smoother.hpp"
#include "lidarena/loop/anchored_trajectory.hpp"
#include "lidarena/loop/loop_closer.hpp"
#include "lidarena/odometry/arena_slam/config.hpp"
#include "lidarena/odometry/arena_slam/keyframes.hpp"
#include "lidarena/odometry/arena_slam/registration.hpp"
#include "lidarena/odometry/odometry.hpp"

namespace lidarena::odometry::arena_slam {

/// LiDAR-inertial SLAM on edges and planes, smoothed with the IMU, with loop closure. It descends
/// from LIO-SAM (Shan, Englot, Meyers, Wang, Ratti, Rus, IROS 2020). Poses hold for the scan's
/// stamp, its first firing. See README.md in this folder.
class ArenaSlam : public Odometry {
 public:
  ArenaSlam(const Config& config, const LidarInfo& lidar, const ImuInfo& imu, Parallel parallel);

  OdometryTraits traits() const override {
    return {
        .needs_imu = true, .revises_past = true, .gravity_aligned = true, .publishes_scans = false};
  }
  void register_imu(const ImuSample& sample) override { imu_.add(sample); }
  ScanResult register_scan(const Scan& scan) override;
  Trajectory trajectory() const override;
  std::vector<Eigen::Vector3f> map() const override { return map::points_of(keyframes_); }
  std::map<std::string, std::uint64_t> memory() const override;

  const loop::LoopCloser& loops() const { return closer_; }

 private:
  /// Prediction of a scan's motion by the IMU.
  struct Prediction {
    Pose world_from_lidar;       ///< at the scan's stamp
    estimation::ImuTrack track;  ///< within the scan, for de-skewing
    Pose track_from_imu;         ///< at the scan's stamp
  };

  /// Instant of the scan's last firing; for a scan without points, its expected instant.
  Time scan_end(const Scan& scan);
  /// Initializes if there are enough IMU samples; returns whether it has.
  bool start(Time stamp, Time end);
  Prediction predict(Time stamp, Time end);
  Registration match(const map::Features& features, const Pose& guess, Time stamp);
  ScanCounters counters_of(const estimation::RangeImage& image, const map::Features& raw,
                           const map::Features& features, const Registration& found) const;
  ScanStatus status_of(const Registration& found, const map::Features& features) const;
  /// Adds the registered pose to the smoother and replaces it by the smoother's.
  void fuse(Registration& found);
  estimation::PoseMeasurement::Information information_of(const Registration& found,
                                                          const Pose& odom_from_imu) const;
  void restart_if_failed();
  /// Makes the scan a keyframe if one is due; a loop then may correct `world_from_lidar`.
  void keep(Time stamp, Pose& world_from_lidar, map::Features features);
  /// Averages the scan into the last keyframe; returns false if it should be the next keyframe.
  bool merge(const Pose& world_from_lidar, const map::Features& features);
  /// The result of a scan that is part of the trajectory.
  ScanResult finish_scan(Time stamp, const Pose& world_from_lidar, ScanStatus status,
                         const ScanCounters& counters);
  ScanResult result_of(Time stamp, const Pose& world_from_lidar, ScanStatus status,
                       const ScanCounters& counters) const;
  estimation::Preintegration empty_preintegration() const {
    return {smoother_.latest().bias, noise_};
  }
  estimation::ImuModel imu_model() const { return {noise_, accel_scale_, smoother_.gravity()}; }

  Config config_;
  Pose body_from_imu_;
  Pose body_from_lidar_;
  Pose imu_from_lidar_;
  estimation::ImuNoise noise_;
  FeatureRule rule_;
  RegistrationLimits limits_;
  Parallel parallel_;

  estimation::ImuBuffer imu_;
  bool started_ = false;
  double accel_scale_ = 1.0;
  Time scan_duration_;  ///< duration of the last scan that had points

  estimation::InertialSmoother smoother_;  ///< in the odometry frame, which has no jumps from loops
  estimation::Preintegration pending_;     ///< since the smoother's last state
  Time integrated_until_{0};
  double longest_gap_s_ = 0.0;  ///< of the IMU, since the last scan
  int restarts_ = 0;
  Pose odom_from_lidar_ = Pose::Identity();   ///< last registered pose, in the smoother's frame
  Pose world_from_lidar_ = Pose::Identity();  ///< the same pose in the map's frame
  Time last_stamp_{Time::min()};

  std::vector<map::Keyframe> keyframes_;
  KeyframeMerger merger_;  ///< of the last keyframe
  map::FeatureMap submap_;
  loop::AnchoredTrajectory poses_;  ///< of the LiDAR
  loop::LoopCloser closer_;
};

}  // namespace lidarena::odometry::arena_slam
