// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/ct_icp/config.hpp"

namespace lidarena::odometry::ct_icp {

Config published(const LidarInfo&) {
  Config config;
  config.sampling.scan_voxel_size_m = 0.5;
  config.sampling.keypoints = KeypointSampling::kGrid;
  config.sampling.keypoint_voxel_size_m = 1.5;
  config.sampling.max_keypoints = 0;
  config.registration.initial_motion = InitialMotion::kConstantMotion;
  config.registration.max_iterations = 5;
  config.registration.inner_iterations = 5;
  config.registration.convergence_translation_m = 1e-3;
  config.registration.convergence_rotation_rad = 1.745e-6;  // 0.0001 deg
  return config;
}

Config indoor(const LidarInfo&) { return {}; }

Config tuned(const LidarInfo&) {
  Config config;
  config.registration.max_rotation_deg = 120.0;
  config.registration.initial_motion = InitialMotion::kConstantMotion;
  config.sampling.scan_voxel_size_m = 0.1;
  config.sampling.max_keypoints = 1500;
  config.map.voxel_size_m = 0.4;
  config.map.always_insert = true;
  return config;
}

}  // namespace lidarena::odometry::ct_icp
