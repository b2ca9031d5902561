// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/fast_lio2/config.hpp"

#include <algorithm>

namespace lidarena::odometry::fast_lio2 {
namespace {

Config original(const LidarInfo& lidar) {
  Config config;
  const bool livox = lidar.kind == "rosette";
  config.point_stride = livox ? 3 : 4;
  config.deskew_first_instant = livox;  // one point with Livox, unused in the program
  return config;
}

Config improved(const LidarInfo& lidar) {
  Config config;
  config.point_stride = 1;
  config.min_range_m = std::max(0.3, lidar.min_range_m);
  config.deskew_first_instant = true;
  config.scan_voxel_size_m = 0.2;
  config.grid_axes = map::GridAxes::kRotated;
  config.max_scan_points = 4000;
  config.map_voxel_size_m = 0.2;
  config.plane_fit = estimation::PlaneFit::kPrincipal;
  config.plane_uncertainty = true;
  config.point_variance_m2 = 4e-4;  // (2 cm)^2 of the data sheets; the plane's variance is added
  config.noise_model = NoiseModel::kDensity;
  config.imu_noise_factor = 10.0;
  config.second_order_integration = true;
  config.detect_saturation = true;
  config.min_inlier_share = 0.75;
  config.skip_first_scan = false;
  config.always_scale_accel = false;
  config.gravity = 9.80665;
  config.initial_sigma = 0.0;
  config.map_radius_m = 1.5 * lidar.max_range_m;
  config.keep_all_scans = false;
  config.zero_velocity_updates = true;
  config.hold_first_pose = true;
  return config;
}

}  // namespace

Config published(const LidarInfo& lidar) { return original(lidar); }

Config indoor(const LidarInfo& lidar) { return improved(lidar); }

}  // namespace lidarena::odometry::fast_lio2
