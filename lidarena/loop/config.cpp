// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/loop/config.hpp"

namespace lidarena::loop {

LoopConfig conservative_loops() {
  LoopConfig config;
  config.keyframes_per_search = 2;
  config.min_time_gap_s = 10.0;
  config.min_path_length_m = 20.0;
  config.search_radius_m = 10.0;
  config.descriptor_candidates = 3;
  config.source_keyframes = 4;
  config.target_keyframes = 8;
  config.voxel_size_m = 0.2;
  config.max_source_points = 1000;
  config.metric = IcpMetric::kPlanes;
  config.max_correspondence_distance_m = 2.0;
  config.max_iterations = 40;
  config.max_fitness_m2 = 0.01;
  config.min_overlap = 0.7;
  config.min_constraint = 0.005;
  config.translation_drift_m_per_m = 0.02;
  config.rotation_drift_rad_per_m = 0.002;
  config.min_consistent_loops = 2;
  config.loop_translation_sigma_m = 0.03;
  config.loop_rotation_sigma_rad = 3e-3;
  config.robust_kernel_scale = 3.0;
  return config;
}

}  // namespace lidarena::loop
