// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/rig.hpp"
#include "lidarena/loop/anchored_trajectory.hpp"
#include "lidarena/odometry/lio_sam/features.hpp"
#include "lidarena/odometry/lio_sam/imu_odometry.hpp"
#include "lidarena/odometry/lio_sam/loop_search.hpp"
#include "lidarena/odometry/lio_sam/registration.hpp"
#include "lidarena/odometry/odometry.hpp"

namespace lidarena::odometry::lio_sam {

/// Whether a scan at `stamp` and `world_from_lidar` should be a keyframe, given the last one: it
/// has moved, or, with Livox sensors, the last one is older than a second.
bool is_keyframe(const map::Keyframe& last, Time stamp, const Pose& world_from_lidar,
                 const Config& config);

/// LiDAR-inertial odometry on edges and planes, smoothed with the IMU: Shan, Englot, Meyers, Wang,
/// Ratti, Rus, "LIO-SAM: Tightly-coupled Lidar Inertial Odometry via Smoothing and Mapping" (IROS
/// 2020). Poses hold for the scan's stamp, its first firing. See README.md in this folder.
class LioSam : public Odometry {
 public:
  LioSam(const Config& config, const LidarInfo& lidar, const ImuInfo& imu, Parallel parallel);

  OdometryTraits traits() const override {
    return {.needs_imu = true,
            .revises_past = config_.loop_closure,
            .gravity_aligned = true,
            .publishes_scans = false};
  }
  void register_imu(const ImuSample& sample) override { imu_.register_imu(sample); }
  Trajectory trajectory() const override;
  std::vector<Eigen::Vector3f> map() const override { return map::points_of(keyframes_); }
  MemoryUse memory() const override;

 protected:
  ScanResult track(const Scan& scan) override;

 private:
  /// The motion within a scan, by the IMU.
  struct Within {
    Time end{0};  ///< of the last point in message order
    estimation::ImuTrack track;
  };
  bool is_due(Time stamp) const;
  map::Features features_of(const Scan& scan, const Within& within, ScanResult& counted) const;
  /// Initial guess of the registration: the last pose and the motion of the IMU odometry since the
  /// latest guess that used it, which lies further back if the IMU odometry has been silent.
  Pose guess();
  /// Registers features, if they are enough; the pose is else the guess.
  Registration match(const map::Features& features, const Pose& guess, Time stamp);
  /// Tells the IMU odometry how far scan matching moved from the pose `before` the guess.
  void feed_back(const Pose& before, const Registration& found);
  /// Makes the scan a keyframe if one is due; a loop then may correct world_from_lidar_.
  void keep(Time stamp, map::Features features);
  ScanStatus status_of(const Registration& found) const;
  /// Adds the latest pose to the trajectory.
  ScanResult processed(Time stamp, ScanStatus status, const Within& within, ScanResult counted);
  ScanResult result_of(const StampedPose& lidar, ScanStatus status, const Within& within,
                       ScanResult counted) const;
  /// world_from_lidar_ and the motion since, by the IMU.
  Pose predicted() const { return world_from_lidar_ * imu_.motion_since_sent(); }

  Config config_;
  Pose body_from_lidar_;
  Pose body_from_imu_;
  Parallel parallel_;
  ImuOdometry imu_;
  std::optional<Time> last_processed_;

  Pose world_from_lidar_;  ///< of the last processed scan
  Pose last_match_;        ///< of the last scan with enough features, before loops
  Pose world_from_odom_ = Pose::Identity();  ///< by which loops have moved the pose
  Pose odom_from_lidar_;                     ///< chain of the motions fed back, without loops
  bool degenerate_ = false;                  ///< the last registration was
  std::optional<Pose> guess_origin_;  ///< of the IMU odometry, at the latest guess that used it

  std::vector<map::Keyframe> keyframes_;
  FeatureRule rule_;
  map::FeatureVoxels voxels_;
  map::FeatureMap submap_;
  LoopSearch loops_;
  loop::AnchoredTrajectory poses_;  ///< of the body
};

}  // namespace lidarena::odometry::lio_sam
