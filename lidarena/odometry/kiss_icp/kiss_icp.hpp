// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/rig.hpp"
#include "lidarena/map/voxel_hash_map.hpp"
#include "lidarena/odometry/kiss_icp/adaptive_threshold.hpp"
#include "lidarena/odometry/kiss_icp/config.hpp"
#include "lidarena/odometry/kiss_icp/preprocess.hpp"
#include "lidarena/odometry/kiss_icp/registration.hpp"
#include "lidarena/odometry/odometry.hpp"

namespace lidarena::odometry::kiss_icp {

/// LiDAR odometry by scan-to-map ICP with an adaptive search radius, after Vizzo, Guadagnino,
/// Mersch, Wiesmann, Behley, Stachniss, "KISS-ICP" (IEEE RA-L 2023). See README.md in this
/// folder.
class KissIcp : public Odometry {
 public:
  KissIcp(const Config& config, const LidarInfo& lidar, Parallel parallel);

  OdometryTraits traits() const override { return {}; }
  ScanResult register_scan(const Scan& scan) override;
  Trajectory trajectory() const override { return Trajectory(poses_, "kiss_icp"); }
  std::vector<Eigen::Vector3f> map() const override;
  std::span<const Eigen::Vector3f> registered_scan() const override { return registered_scan_; }
  std::map<std::string, std::uint64_t> memory() const override;

 private:
  /// Registers a part of a scan and appends its points to `registered_scan_`.
  ScanResult register_slice(const Scan& slice);
  /// Calls register_points from the predicted pose. With redeskew_first_scan, the second scan first
  /// replaces the first one in the map by its de-skewed points.
  Registration registered(const TimedPoints& keypoints, const PreviousPose& previous_pose,
                          const Pose& guess);
  Time reference_of(const estimation::ScanTimes& times) const {
    return pose_time(times, config_.pose_instant);
  }
  /// The previous pose of the lidar, with the twist `before` up to it.
  PreviousPose previous_pose(const estimation::ScanTimes& times, const se3::Vector6& before) const;
  /// Predicted motion of the lidar since the previous pose, with constant velocity.
  Pose predicted_motion(const estimation::ScanTimes& times) const;
  ScanStatus status_of(const Registration& registration, std::size_t points) const;
  /// Stores the scan's pose and the motion up to it.
  void advance(const Pose& pose, const estimation::ScanTimes& times, ScanStatus status);
  /// Poses of the body within the scan, as used for de-skewing; empty if it was not de-skewed.
  std::vector<StampedPose> motion_within(const estimation::ScanTimes& times,
                                         const se3::Vector6& twist) const;
  /// Pose of the body in the world, which is the body's frame at the start.
  Pose body_pose(const Pose& map_from_lidar) const;

  Config config_;
  Pose body_from_lidar_;
  Parallel parallel_;
  map::VoxelHashMap map_;     ///< in the lidar's frame at its first pose
  TimedPoints first_points_;  ///< of the first scan, kept until the second one de-skews it
  AdaptiveThreshold threshold_;
  double scan_motion_share_ =
      0.0;  ///< the configured value, 0 during the first initial_scans scans

  Pose map_from_lidar_ = Pose::Identity();
  Pose motion_ = Pose::Identity();  ///< of the lidar, between the last two scans
  double motion_seconds_;           ///< duration of motion_
  std::optional<Time> instant_;     ///< of the last pose
  Time scan_duration_;              ///< of the last scan that had times
  std::vector<StampedPose> poses_;  ///< of the body
  std::vector<Eigen::Vector3f> registered_scan_;
};

}  // namespace lidarena::odometry::kiss_icp
