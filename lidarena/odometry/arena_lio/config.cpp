// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lio/config.hpp"

#include <algorithm>

namespace lidarena::odometry::arena_lio {

Config settings_for(const LidarInfo& lidar) {
  Config config;
  config.min_range_m = std::max(config.min_range_m, lidar.min_range_m);
  config.map.radius_m = 1.5 * lidar.max_range_m;
  return config;
}

}  // namespace lidarena::odometry::arena_lio
