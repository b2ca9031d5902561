// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/lidar_path.hpp"

namespace lidarena::odometry {

estimation::ScanTimes LidarPath::times_of(const Scan& scan) const {
  return estimation::times_of(scan, scan_duration_);
}

Pose LidarPath::body_pose(const Pose& map_from_lidar) const {
  return body_from_lidar_ * map_from_lidar * body_from_lidar_.inverse();
}

void LidarPath::add(const Pose& map_from_lidar, Time instant, const estimation::ScanTimes& times) {
  poses_.push_back({instant, body_pose(map_from_lidar)});
  if (times.timed) scan_duration_ = times.last - times.first;
}

}  // namespace lidarena::odometry
