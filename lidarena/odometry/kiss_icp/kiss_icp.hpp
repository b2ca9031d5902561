// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/map/voxel_hash_map.hpp"
#include "lidarena/odometry/kiss_icp/adaptive_threshold.hpp"
#include "lidarena/odometry/kiss_icp/config.hpp"
#include "lidarena/odometry/kiss_icp_steps.hpp"
#include "lidarena/odometry/lidar_path.hpp"
#include "lidarena/odometry/odometry.hpp"

namespace lidarena::odometry::kiss_icp {

/// LiDAR odometry by scan-to-map ICP with an adaptive search radius: Vizzo, Guadagnino, Mersch,
/// Wiesmann, Behley, Stachniss, "KISS-ICP" (IEEE RA-L 2023), as release v0.2. See README.md.
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
  /// Twist for the scan's de-skewing; none if the published program would not de-skew it.
  std::optional<se3::Vector6> twist_of(const Scan& scan, const estimation::ScanTimes& times) const;
  /// Adds the scan to the map and stores its pose and the motion up to it.
  void advance(const Pose& pose, const Points& map_points, const estimation::ScanTimes& times);

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
