// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/rig.hpp"
#include "lidarena/map/voxel_hash_map.hpp"
#include "lidarena/odometry/arena_lo/config.hpp"
#include "lidarena/odometry/arena_lo/prediction.hpp"
#include "lidarena/odometry/arena_lo/robust_registration.hpp"
#include "lidarena/odometry/arena_lo/sampling.hpp"
#include "lidarena/odometry/odometry.hpp"

namespace lidarena::odometry::arena_lo {

/// LiDAR odometry by elastic scan-to-map registration: a scan has a pose at its beginning and one
/// at its end, after Dellenbach, Deschaud, Jacquet, Goulette, "CT-ICP: Real-time Elastic LiDAR
/// Odometry with Loop Closure" (ICRA 2022). See README.md in this folder.
class ArenaLo : public Odometry {
 public:
  ArenaLo(const Config& config, const LidarInfo& lidar, Parallel parallel);

  OdometryTraits traits() const override { return {}; }
  ScanResult register_scan(const Scan& scan) override;
  Trajectory trajectory() const override { return Trajectory(poses_, "arena_lo"); }
  std::vector<Eigen::Vector3f> map() const override;
  std::span<const Eigen::Vector3f> registered_scan() const override { return registered_scan_; }
  std::map<std::string, std::uint64_t> memory() const override;

 private:
  /// Aligns the downsampled scan with the map, if there is one; returns the guess if that fails.
  RobustRegistration align(std::span<const TimedPoint> frame,
                           const estimation::ElasticMotion& guess);
  ScanStatus status_of(const RobustRegistration& found, std::size_t points) const;
  /// Whether the published program would end at this failed registration.
  bool stops_when_lost(const RobustRegistration& found) const;
  /// Stores the scan's motion.
  void advance(const RobustRegistration& found, const estimation::ScanTimes& times,
               ScanStatus status);
  /// Poses of the body within the scan; empty if the scan is rigid.
  std::vector<StampedPose> motion_within(const estimation::ElasticMotion& motion,
                                         const estimation::ScanTimes& times) const;
  /// Pose of the body in the world, which is the body's frame at the start.
  Pose body_pose(const Pose& map_from_lidar) const;
  bool starting() const { return scans_ < config_.sampling.initial_scans; }

  Config config_;
  Pose body_from_lidar_;
  Parallel parallel_;
  map::VoxelHashMap map_;  ///< in the lidar's frame at its first pose
  InsertionGate gate_;
  MotionHistory history_;

  int scans_ = 0;
  int first_level_ = 0;             ///< of the next scan's registration
  Time scan_duration_;              ///< of the last scan that had times
  std::vector<StampedPose> poses_;  ///< of the body
  std::vector<Eigen::Vector3f> registered_scan_;
};

}  // namespace lidarena::odometry::arena_lo
