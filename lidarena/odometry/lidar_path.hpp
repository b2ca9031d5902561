// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "lidarena/base/rig.hpp"
#include "lidarena/estimation/scan_times.hpp"
#include "lidarena/odometry/odometry.hpp"

namespace lidarena::odometry {

/// The path of a body, from the poses of its lidar in a map: the lidar's frame at its first pose.
class LidarPath {
 public:
  explicit LidarPath(const LidarInfo& lidar)
      : body_from_lidar_(lidar.body_from_lidar),
        scan_duration_(from_seconds(1.0 / lidar.rate_hz)) {}

  /// An empty scan counts as lasting as long as the last one that had times.
  estimation::ScanTimes times_of(const Scan& scan) const;
  /// Adds the pose of a scan at `times`; it holds at `instant`.
  void add(const Pose& map_from_lidar, Time instant, const estimation::ScanTimes& times);

  const Pose& body_from_lidar() const { return body_from_lidar_; }
  /// world_from_body of a pose of the lidar. World: the body's frame at its first pose.
  Pose body_pose(const Pose& map_from_lidar) const;
  /// Of the body, one for each pose of the lidar.
  const std::vector<StampedPose>& poses() const { return poses_; }
  std::uint64_t memory_bytes() const { return poses_.capacity() * sizeof(StampedPose); }

 private:
  Pose body_from_lidar_;
  Time scan_duration_;  ///< of the last scan that had times
  std::vector<StampedPose> poses_;
};

}  // namespace lidarena::odometry
