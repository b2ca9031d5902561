// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/ct_icp/config.hpp"

#include <algorithm>

namespace lidarena::odometry::ct_icp {

namespace {

Config original() { return {}; }

Config improved(const LidarInfo& lidar) {
  Config config;
  SamplingConfig& sampling = config.sampling;
  sampling.min_range_m = lidar.min_range_m;
  sampling.max_range_m = lidar.max_range_m;
  sampling.frame_voxel_m = 0.1;
  sampling.keypoint_voxel_m = 0.25;
  sampling.keypoints = KeypointSampling::kGrid;
  sampling.max_keypoints = 2500;
  sampling.start_scans = 0;
  sampling.rigid_scans = 1;
  config.cell_rounding = map::VoxelRounding::kFloor;

  RegistrationConfig& registration = config.registration;
  registration.solver = Solver::kGaussNewton;
  registration.initial_motion = InitialMotion::kConstantTwist;
  registration.segments = 3;
  registration.search_again_m = 0.03;
  registration.robust_kernel_scale_m = 0.05;
  registration.inner_iterations = 1;
  registration.max_iterations = 30;
  registration.translation_threshold_m = 1e-3;
  registration.rotation_threshold_rad = 2e-4;
  registration.search_radius_m = 0.4;
  registration.min_neighbors = 10;
  registration.plane_point = PlanePoint::kMean;
  registration.gate_distances = true;
  registration.start_iterations = 0;
  registration.min_residuals = 50;

  config.prior.location = 0.01;
  config.prior.orientation = 0.01;
  config.prior.bend = 0.01;
  config.prior.angular_bend = 0.02;

  config.map = {0.4, 40, 0.05, 1.5 * lidar.max_range_m};
  config.insertion.rule = Insertion::kAlways;
  config.robust.max_turn_rad = 1.2;  // 690 deg/s at 10 Hz: aggressive flights reach 330 deg/s
  config.robust.stop_when_lost = false;
  config.robust.motion_kept_when_lost = 0.5;
  return config;
}

}  // namespace

std::vector<std::string> preset_names() { return {"improved", "original"}; }

Config preset(const std::string& name, const LidarInfo& lidar) {
  if (name == "improved") return improved(lidar);
  if (name == "original") return original();
  const std::string nearest = nearest_word(name, preset_names());
  throw InputError(
      "preset", "ct_icp has no preset '" + name + "'",
      nearest.empty() ? "use improved or original" : "did you mean '" + nearest + "'?");
}

}  // namespace lidarena::odometry::ct_icp
