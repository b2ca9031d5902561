// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/kiss_icp/config.hpp"

namespace lidarena::odometry::kiss_icp {

namespace {

Config latest() { return {}; }

/// The published program of the paper's year, tag v0.2.
Config original() {
  Config config;
  config.min_range_m = 5.0;
  config.min_spacing = false;
  config.voxel_rounding = map::VoxelRounding::kTruncate;
  config.thinning_order = map::ThinningOrder::kTeschner;
  config.pose_instant = PoseInstant::kScanMiddle;
  config.threshold_start = ThresholdStart::kUntilMoved;
  config.kernel_fraction = 1.0 / 3.0;
  return config;
}

Config improved(const LidarInfo& lidar) {
  Config config;
  config.thinning_order = map::ThinningOrder::kMixed;
  config.max_range_m = lidar.max_range_m;
  config.min_range_m = lidar.min_range_m;
  config.voxel_size_m = 0.4;
  config.map_thinning = 0.25;
  config.keypoint_thinning = 1.0;
  config.plane_thinness = 0.2;
  config.degenerate_cell_weight = 1e-4;
  config.slices = 2;
  config.slice_above_m = 0.15;
  config.scan_motion_share = 0.75;
  config.initial_scans = 5;
  config.redeskew_first_scan = true;
  config.initial_threshold_m = 0.2;
  config.threshold_memory = 10.0;
  config.threshold_lever = ThresholdLever::kMeanRange;
  config.kernel_scale_in_meters = true;
  config.max_iterations = 20;
  config.convergence = 1e-3;
  config.ignore_equal_times = true;
  config.motion_per_second = true;
  config.lost_motion_factor = 0.5;
  config.sensor_centered = true;
  return config;
}

}  // namespace

Config published(const LidarInfo&) { return original(); }

Config head(const LidarInfo&) { return latest(); }

Config indoor(const LidarInfo& lidar) { return improved(lidar); }

}  // namespace lidarena::odometry::kiss_icp
