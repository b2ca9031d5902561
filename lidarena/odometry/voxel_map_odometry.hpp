// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/rig.hpp"
#include "lidarena/estimation/scan_times.hpp"
#include "lidarena/map/voxel_hash_map.hpp"
#include "lidarena/odometry/odometry.hpp"

namespace lidarena::odometry {

/// What odometries without an IMU that register scans with a voxel map have in common. Such a
/// method implements register_scan().
class VoxelMapOdometry : public Odometry {
 public:
  OdometryTraits traits() const override { return {}; }
  Trajectory trajectory() const override { return Trajectory(poses_, name_); }
  std::vector<Eigen::Vector3f> map() const override;
  std::span<const Eigen::Vector3f> registered_scan() const override { return registered_scan_; }
  std::map<std::string, std::uint64_t> memory() const override;

 protected:
  /// `name`: of the trajectory.
  VoxelMapOdometry(const char* name, const LidarInfo& lidar,
                   const map::VoxelHashMap::Options& options, Parallel parallel);

  /// An empty scan counts as lasting as long as the last one that had times.
  estimation::ScanTimes times_of(const Scan& scan) const;
  /// Whether a pose at `instant` would not be later than the last one.
  bool is_out_of_order(Time instant) const;
  /// The result of a scan that changes nothing.
  ScanResult unchanged(ScanStatus status, const ScanCounters& counters) const;
  /// Stores the pose of a scan at `times`; it holds at `instant`.
  void store(const Pose& map_from_lidar, Time instant, const estimation::ScanTimes& times);

  Pose body_from_lidar_;
  Parallel parallel_;
  map::VoxelHashMap map_;           ///< in the lidar's frame at its first pose
  std::vector<StampedPose> poses_;  ///< of the body; its frame at the start is the world
  std::vector<Eigen::Vector3f> registered_scan_;

 private:
  const char* name_;
  Time scan_duration_;  ///< of the last scan that had times
};

}  // namespace lidarena::odometry
