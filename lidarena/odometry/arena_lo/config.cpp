// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lo/config.hpp"

#include <algorithm>

namespace lidarena::odometry::arena_lo {

namespace {

Config original() { return {}; }

Config improved(const LidarInfo& lidar) {
  Config config;
  SamplingConfig& sampling = config.sampling;
  sampling.min_range_m = lidar.min_range_m;
  sampling.max_range_m = lidar.max_range_m;
  sampling.scan_voxel_size_m = 0.1;
  sampling.keypoint_voxel_size_m = 0.25;
  sampling.keypoints = KeypointSampling::kGrid;
  sampling.max_keypoints = 2500;
  sampling.initial_scans = 0;
  sampling.rigid_scans = 1;
  config.voxel_rounding = map::VoxelRounding::kFloor;

  RegistrationConfig& registration = config.registration;
  registration.solver = Solver::kGaussNewton;
  registration.initial_motion = InitialMotion::kConstantTwist;
  registration.segments = 3;
  registration.reassociation_distance_m = 0.03;
  registration.robust_kernel_scale_m = 0.05;
  registration.inner_iterations = 1;
  registration.max_iterations = 30;
  registration.convergence_translation_m = 1e-3;
  registration.convergence_rotation_rad = 2e-4;
  registration.search_radius_m = 0.4;
  registration.min_neighbors = 10;
  registration.plane_point = PlanePoint::kMean;
  registration.gate_distances = true;
  registration.initial_iterations = 0;
  registration.min_residuals = 50;

  config.prior.location = 0.01;
  config.prior.orientation = 0.01;
  config.prior.velocity_change = 0.01;
  config.prior.angular_velocity_change = 0.02;

  config.map = {0.4, 40, 0.05, 1.5 * lidar.max_range_m};
  config.insertion.rule = Insertion::kAlways;
  config.robust.lost_rotation_rad = 1.2;  // 690 deg/s at 10 Hz: aggressive flights reach 330 deg/s
  config.robust.stop_when_lost = false;
  config.robust.lost_motion_factor = 0.5;
  return config;
}

}  // namespace

Config indoor(const LidarInfo& lidar) { return improved(lidar); }

}  // namespace lidarena::odometry::arena_lo
