// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/kiss_icp/config.hpp"

namespace lidarena::odometry::kiss_icp {

Config published(const LidarInfo&) {
  Config config;
  config.min_range_m = 5.0;
  config.deskew = false;
  return config;
}

Config indoor(const LidarInfo&) {
  Config config;
  config.max_range_m = 50.0;
  return config;
}

Config tuned(const LidarInfo&) {
  Config config;
  config.max_range_m = 20.0;
  config.voxel_size_m = 0.15;
  config.max_iterations = 100;
  return config;
}

}  // namespace lidarena::odometry::kiss_icp
