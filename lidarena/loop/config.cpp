// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/loop/config.hpp"

namespace lidarena::loop {

LoopConfig careful_loops() {
  LoopConfig config;
  config.keyframes_per_search = 2;
  config.least_gap_s = 10.0;
  config.least_way_m = 20.0;
  config.search_radius_m = 10.0;
  config.appearance_candidates = 3;
  config.source_keyframes = 4;
  config.target_keyframes = 8;
  config.leaf_m = 0.2;
  config.source_points = 1000;
  config.metric = IcpMetric::kPlanes;
  config.correspondence_m = 2.0;
  config.max_iterations = 40;
  config.max_fitness_m2 = 0.01;
  config.least_overlap = 0.7;
  config.least_constraint = 0.005;
  config.drift_per_meter = 0.02;
  config.turn_drift_rad_per_meter = 0.002;
  config.agreeing_loops = 2;
  config.loop_shift_sigma_m = 0.03;
  config.loop_turn_sigma_rad = 3e-3;
  config.robust_scale = 3.0;
  return config;
}

}  // namespace lidarena::loop
