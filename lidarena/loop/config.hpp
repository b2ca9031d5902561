// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <utility>

#include "lidarena/base/config.hpp"

namespace lidarena {

/// What two places are laid on each other by.
enum class IcpMetric {
  kPoints,  ///< distances to the nearest points
  kPlanes,  ///< distances to the planes through them
};

/// How loops are looked for, judged and used. The defaults are LIO-SAM's.
struct LoopConfig {
  int keyframes_per_search = 1;
  double least_gap_s = 30.0;
  double least_way_m = 0.0;
  double search_radius_m = 15.0;
  int appearance_candidates = 0;
  double appearance_distance = 0.3;
  double appearance_range_m = 30.0;

  int source_keyframes = 0;
  int target_keyframes = 25;
  double leaf_m = 0.4;
  int source_points = 0;
  int least_source_points = 300;
  int least_target_points = 1000;
  IcpMetric metric = IcpMetric::kPoints;
  double correspondence_m = 30.0;
  int max_iterations = 100;
  double max_fitness_m2 = 0.3;
  double inlier_m = 0.3;
  double least_overlap = 0.0;
  double least_constraint = 0.0;

  double drift_per_meter = 0.0;
  double turn_drift_rad_per_meter = 0.0;
  double drift_gate = 3.0;
  int agreeing_loops = 1;
  double agreement_m = 0.3;
  double agreement_rad = 0.03;

  double odometry_shift_sigma_m = 0.01;
  double odometry_turn_sigma_rad = 1e-3;
  double loop_shift_sigma_m = 0.0;
  double loop_turn_sigma_rad = 0.0;
  double robust_scale = 0.0;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("keyframes_per_search", self.keyframes_per_search, "", "a loop is looked for every so many",
      at_least(1));
    v("least_gap_s", self.least_gap_s, "s", "between the two visits of a place", at_least(0));
    v("least_way_m", self.least_way_m, "m",
      "of measured motion between the two, loops that are known included: less drift than a loop "
      "could cure; 0: loops are added however little they tell",
      at_least(0));
    v("search_radius_m", self.search_radius_m, "m",
      "the nearest keyframe within it is tried; 0: none", at_least(0));
    v("appearance_candidates", self.appearance_candidates, "",
      "so many keyframes that look alike are tried, wherever they are", at_least(0));
    v("appearance_distance", self.appearance_distance, "",
      "of descriptors, at most: 0 alike, 1 not", at_least(0));
    v("appearance_range_m", self.appearance_range_m, "m", "that descriptors see", above(0));
    v("source_keyframes", self.source_keyframes, "", "before the new one that are matched with it",
      at_least(0));
    v("target_keyframes", self.target_keyframes, "", "on each side of the old one", at_least(0));
    v("leaf_m", self.leaf_m, "m", "both clouds are averaged in cells of this edge", above(0));
    v("source_points", self.source_points, "", "so many of the new place's are matched; 0: all",
      at_least(0));
    v("least_source_points", self.least_source_points, "", "", at_least(1));
    v("least_target_points", self.least_target_points, "", "", at_least(1));
    v("metric", self.metric, "", "points or planes");
    v("correspondence_m", self.correspondence_m, "m", "to the nearest point, at most", above(0));
    v("max_iterations", self.max_iterations, "", "of ICP", at_least(1));
    v("max_fitness_m2", self.max_fitness_m2, "m^2",
      "mean squared distance of corresponding points, at most", above(0));
    v("inlier_m", self.inlier_m, "m", "nearer points overlap", above(0));
    v("least_overlap", self.least_overlap, "", "share of the new place's points that overlap",
      between(0, 1));
    v("least_constraint", self.least_constraint, "",
      "share of the least held direction in all that the points tell (planes only)", between(0, 1));
    v("drift_per_meter", self.drift_per_meter, "m/m",
      "sigma of the odometry's drift; a loop that asks for more than `drift_gate` of it is "
      "refused; "
      "0: any is believed",
      at_least(0));
    v("turn_drift_rad_per_meter", self.turn_drift_rad_per_meter, "rad/m", "likewise", at_least(0));
    v("drift_gate", self.drift_gate, "sigma", "", above(0));
    v("agreeing_loops", self.agreeing_loops, "",
      "so many that ask for the same correction are needed before one is believed", at_least(1));
    v("agreement_m", self.agreement_m, "m", "loops that agree differ by less", above(0));
    v("agreement_rad", self.agreement_rad, "rad", "likewise", above(0));
    v("odometry_shift_sigma_m", self.odometry_shift_sigma_m, "m", "from keyframe to keyframe",
      above(0));
    v("odometry_turn_sigma_rad", self.odometry_turn_sigma_rad, "rad", "likewise", above(0));
    v("loop_shift_sigma_m", self.loop_shift_sigma_m, "m",
      "of a loop; 0: the fitness is its variance, in m^2 and rad^2 alike", at_least(0));
    v("loop_turn_sigma_rad", self.loop_turn_sigma_rad, "rad", "likewise", at_least(0));
    v("robust_scale", self.robust_scale, "sigma",
      "beyond which a loop counts less and less (Cauchy); 0: always in full", at_least(0));
  }
};

/// Loops that are tried by place and by looks, judged by overlap, fit and what the odometry may
/// have drifted, and believed only when two agree.
LoopConfig careful_loops();

}  // namespace lidarena

namespace lidarena {

template <>
struct EnumNames<IcpMetric> {
  static constexpr std::array names{std::pair{"points", IcpMetric::kPoints},
                                    std::pair{"planes", IcpMetric::kPlanes}};
};

}  // namespace lidarena
