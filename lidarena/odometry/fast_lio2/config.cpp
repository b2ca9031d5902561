// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/fast_lio2/config.hpp"

namespace lidarena::odometry::fast_lio2 {

Config published(const LidarInfo& lidar) {
  Config config;
  if (lidar.kind == "rosette") {
    config.point_stride = 3;
    config.detection_range_m = 100.0;
  }
  return config;
}

Config indoor(const LidarInfo& lidar) {
  Config config = published(lidar);
  config.scan_voxel_size_m = 0.2;
  config.map_voxel_size_m = 0.2;
  return config;
}

Config tuned(const LidarInfo& lidar) {
  Config config = published(lidar);
  config.point_stride = 2;
  config.scan_voxel_size_m = 0.1;
  config.map_voxel_size_m = 0.1;
  config.gyro_variance = 0.01;
  config.accel_variance = 0.01;
  return config;
}

}  // namespace lidarena::odometry::fast_lio2
