// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/lio_sam/config.hpp"

namespace lidarena::odometry::lio_sam {
namespace {

void set_indoor_voxels(Config& config) {
  config.row_surface_voxel_size_m = 0.2;
  config.edge_voxel_size_m = 0.1;
  config.surface_voxel_size_m = 0.2;
}

/// The port's file for a Mid-360 with the IMU inside it.
Config livox() {
  Config config;
  config.sensor = Sensor::kLivox;
  config.max_range_m = 40.0;
  set_indoor_voxels(config);
  config.keyframe_translation_m = 0.5;
  config.keyframe_rotation_rad = 0.1;
  config.submap_radius_m = 20.0;
  config.submap_keyframe_spacing_m = 0.5;
  config.gravity = 9.8035;
  config.gyro_noise_density = 1e-4;
  config.accel_noise_density = 1e-4;
  config.gyro_bias_walk = 0.04;
  config.accel_bias_walk = 0.19;
  return config;
}

}  // namespace

Config published(const LidarInfo& lidar) {
  if (lidar.kind != "spinning") return livox();
  Config config;
  if (lidar.columns > 0) config.columns = lidar.columns;
  return config;
}

Config indoor(const LidarInfo& lidar) {
  Config config = published(lidar);
  set_indoor_voxels(config);
  config.min_range_m = 0.5;
  return config;
}

Config tuned(const LidarInfo& lidar) {
  Config config = indoor(lidar);
  config.process_interval_s = 0.07;
  return config;
}

}  // namespace lidarena::odometry::lio_sam
