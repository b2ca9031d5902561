// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/map/voxel_hash_map.hpp"
#include "lidarena/odometry/kiss_icp/adaptive_threshold.hpp"
#include "lidarena/odometry/kiss_icp/config.hpp"
#include "lidarena/odometry/kiss_icp/preprocess.hpp"
#include "lidarena/odometry/kiss_icp/registration.hpp"
#include "lidarena/odometry/lidar_path.hpp"
#include "lidarena/odometry/odometry.hpp"

namespace lidarena::odometry::kiss_icp {

/// LiDAR odometry by scan-to-map ICP with an adaptive search radius: Vizzo, Guadagnino, Mersch,
/// Wiesmann, Behley, Stachniss, "KISS-ICP" (IEEE RA-L 2023). See README.md in this folder.
class KissIcp : public Odometry {
 public:
  KissIcp(const Config& config, const LidarInfo& lidar, Parallel parallel);

  OdometryTraits traits() const override { return {.publishes_scans = true}; }
  Trajectory trajectory() const override { return Trajectory(path_.poses(), "kiss_icp"); }
  std::vector<Eigen::Vector3f> map() const override;
  std::span<const Eigen::Vector3f> registered_scan() const override { return registered_scan_; }
  MemoryUse memory() const override;

 protected:
  ScanResult track(const Scan& scan) override;

 private:
  /// The scan's points within the range gate, in the lidar's frame at `instant`, for a lidar that
  /// moves with `twist`.
  Points preprocess(const Scan& scan, const estimation::ScanTimes& times, const se3::Vector6& twist,
                    Time instant) const;
  /// Whether the published program would de-skew this scan.
  bool deskews(const Scan& scan) const;
  ScanStatus status_of(const Registration& registration, std::size_t points) const;
  /// Adds the scan to the map and stores its pose and the motion up to it.
  void advance(const Pose& pose, const Points& map_points, const estimation::ScanTimes& times);
  /// Poses of the body within the scan, as used for de-skewing; empty if it was not de-skewed.
  std::vector<StampedPose> motion_within(const estimation::ScanTimes& times,
                                         const se3::Vector6& twist) const;

  Config config_;
  Parallel parallel_;
  AdaptiveThreshold threshold_;
  map::VoxelHashMap map_;  ///< in the lidar's frame at its first pose
  LidarPath path_;
  std::vector<Eigen::Vector3f> registered_scan_;

  Pose map_from_lidar_ = Pose::Identity();
  Pose motion_ = Pose::Identity();  ///< of the lidar, between the last two scans
};

}  // namespace lidarena::odometry::kiss_icp
