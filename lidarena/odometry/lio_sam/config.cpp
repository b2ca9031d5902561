// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/lio_sam/config.hpp"

#include <algorithm>

namespace lidarena::odometry::lio_sam {
namespace {

/// The published program's settings for spinning sensors, with voxel sizes and ranges for rooms.
Config original_spinning(const LidarInfo& lidar) {
  Config config;
  config.min_range_m = 0.5;
  if (lidar.columns > 0) config.columns = lidar.columns;
  config.loop.voxel_size_m = config.surface_voxel_size_m;
  return config;
}

/// The settings of its port to the Mid-360 with a 6-axis IMU.
Config original_livox() {
  Config config;
  config.columns_by = Columns::kArrival;
  config.min_range_m = 0.5;
  config.max_range_m = 40.0;
  config.smoothness_neighbors = 2;
  config.edges_per_sector = 40;
  config.occluded_points = 3;
  config.grazing_share = 0.1;
  config.max_iterations = 25;
  config.keyframe_translation_m = 0.5;
  config.keyframe_rotation_rad = 0.1;
  config.keyframe_interval_s = 1.0;
  config.submap_radius_m = 20.0;
  config.submap_keyframe_spacing_m = 0.5;
  config.gravity = 9.8035;
  config.gyro_noise_density = 1e-4;
  config.accel_noise_density = 1e-4;
  config.gyro_bias_walk = 0.04;
  config.accel_bias_walk = 0.19;
  config.loop.voxel_size_m = config.surface_voxel_size_m;
  return config;
}

Config original(const LidarInfo& lidar) {
  return lidar.kind == "spinning" ? original_spinning(lidar) : original_livox();
}

Config improved(const LidarInfo& lidar) {
  Config config = original(lidar);
  config.process_interval_s = 0.0;
  config.min_range_m = std::max(0.3, lidar.min_range_m);
  config.max_range_m = lidar.max_range_m;
  config.deskew_translation = true;
  config.deskew_bias = true;
  config.min_edges = 0;
  config.convergence_rotation_rad = 2e-4;
  config.convergence_translation_m = 2e-4;
  config.reassociation_distance_m = 0.01;
  config.plane_fit = estimation::PlaneFit::kPrincipal;
  config.max_plane_thickness_m = 0.06;
  config.surface_voxel_size_m = 0.15;
  config.grid_axes = map::GridAxes::kRotated;
  config.degeneracy = Degeneracy::kShare;
  config.keyframe_translation_m = 1.0;
  config.keyframe_rotation_rad = 0.2;
  config.keyframe_interval_s = 0.0;
  config.scans_per_keyframe = 16;
  config.submap_radius_m = 20.0;
  config.submap_keyframe_spacing_m = 2.0;
  config.gravity_aligned_start = true;
  config.gravity = 9.80665;
  config.gravity_sigma_rad = 0.02;
  config.imu_noise_factor = 10.0;
  config.min_rotation_sigma_rad = 1e-3;
  config.min_translation_sigma_m = 5e-3;
  config.point_sigma_m = 0.1;
  config.smoothed_pose = true;
  config.loop = loop::conservative_loops();
  return config;
}

}  // namespace

Config published(const LidarInfo& lidar) { return original(lidar); }

Config indoor(const LidarInfo& lidar) { return improved(lidar); }

}  // namespace lidarena::odometry::lio_sam
