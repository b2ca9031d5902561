// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <utility>

#include "lidarena/base/config.hpp"

namespace lidarena::loop {

/// Distances that ICP minimizes.
enum class IcpMetric {
  kPoints,  ///< to the nearest points
  kPlanes,  ///< to the planes through them
};

/// How loops are searched for, verified and used. The defaults are those of LIO-SAM.
struct LoopConfig {
  int keyframes_per_search = 1;
  double min_time_gap_s = 30.0;
  double min_path_length_m = 0.0;
  double search_radius_m = 15.0;
  int descriptor_candidates = 0;
  double max_descriptor_distance = 0.3;
  double descriptor_range_m = 30.0;

  int source_keyframes = 0;
  int target_keyframes = 25;
  double voxel_size_m = 0.4;
  int max_source_points = 0;
  int min_source_points = 300;
  int min_target_points = 1000;
  IcpMetric metric = IcpMetric::kPoints;
  double max_correspondence_distance_m = 30.0;
  int max_iterations = 100;
  double max_fitness_m2 = 0.3;
  double inlier_distance_m = 0.3;
  double min_overlap = 0.0;
  double min_constraint = 0.0;

  double translation_drift_m_per_m = 0.0;
  double rotation_drift_rad_per_m = 0.0;
  double drift_gate = 3.0;
  int min_consistent_loops = 1;
  double consistency_translation_m = 0.3;
  double consistency_rotation_rad = 0.03;

  double odometry_translation_sigma_m = 0.01;
  double odometry_rotation_sigma_rad = 1e-3;
  double loop_translation_sigma_m = 0.0;
  double loop_rotation_sigma_rad = 0.0;
  double robust_kernel_scale = 0.0;

  /// Former names, for the message that names the new one.
  static constexpr RenamedKey renamed_keys[] = {
      {"least_gap_s", "min_time_gap_s"},
      {"least_way_m", "min_path_length_m"},
      {"appearance_candidates", "descriptor_candidates"},
      {"appearance_distance", "max_descriptor_distance"},
      {"appearance_range_m", "descriptor_range_m"},
      {"leaf_m", "voxel_size_m"},
      {"source_points", "max_source_points"},
      {"least_source_points", "min_source_points"},
      {"least_target_points", "min_target_points"},
      {"correspondence_m", "max_correspondence_distance_m"},
      {"inlier_m", "inlier_distance_m"},
      {"least_overlap", "min_overlap"},
      {"least_constraint", "min_constraint"},
      {"drift_per_metre", "translation_drift_m_per_m"},
      {"turn_drift_rad_per_metre", "rotation_drift_rad_per_m"},
      {"agreeing_loops", "min_consistent_loops"},
      {"agreement_m", "consistency_translation_m"},
      {"agreement_rad", "consistency_rotation_rad"},
      {"odometry_shift_sigma_m", "odometry_translation_sigma_m"},
      {"odometry_turn_sigma_rad", "odometry_rotation_sigma_rad"},
      {"loop_shift_sigma_m", "loop_translation_sigma_m"},
      {"loop_turn_sigma_rad", "loop_rotation_sigma_rad"},
      {"robust_scale", "robust_kernel_scale"}};

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("keyframes_per_search", self.keyframes_per_search, "",
      "search for a loop at every n-th keyframe", at_least(1));
    v("min_time_gap_s", self.min_time_gap_s, "s", "minimum time between the two visits of a place",
      at_least(0));
    v("min_path_length_m", self.min_path_length_m, "m",
      "minimum path length between the two visits, by the shortest path through known loops; after "
      "less there is too little drift to correct; 0: no minimum",
      at_least(0));
    v("search_radius_m", self.search_radius_m, "m",
      "the nearest keyframe within this distance is a candidate; 0: no candidates by distance",
      at_least(0));
    v("descriptor_candidates", self.descriptor_candidates, "",
      "maximum number of candidates per search by similar appearance, at any distance",
      at_least(0));
    v("max_descriptor_distance", self.max_descriptor_distance, "",
      "maximum distance between place descriptors: 0 equal, 1 nothing in common", at_least(0));
    v("descriptor_range_m", self.descriptor_range_m, "m",
      "maximum range of the points in a place descriptor", above(0));
    v("source_keyframes", self.source_keyframes, "",
      "number of keyframes before the new one whose points are matched with its own", at_least(0));
    v("target_keyframes", self.target_keyframes, "",
      "number of keyframes on each side of the old one whose points are matched", at_least(0));
    v("voxel_size_m", self.voxel_size_m, "m",
      "voxel size in which the points of both clouds are averaged", above(0));
    v("max_source_points", self.max_source_points, "",
      "upper limit on the points of the new place that are matched; 0: all", at_least(0));
    v("min_source_points", self.min_source_points, "", "minimum number of points of the new place",
      at_least(1));
    v("min_target_points", self.min_target_points, "", "minimum number of points of the old place",
      at_least(1));
    v("metric", self.metric, "", "distances that ICP minimizes: to points or planes");
    v("max_correspondence_distance_m", self.max_correspondence_distance_m, "m",
      "maximum distance to a corresponding point", above(0));
    v("max_iterations", self.max_iterations, "", "maximum number of iterations of ICP",
      at_least(1));
    v("max_fitness_m2", self.max_fitness_m2, "m^2",
      "maximum mean squared distance of corresponding points", above(0));
    v("inlier_distance_m", self.inlier_distance_m, "m",
      "points within this distance of the other cloud overlap", above(0));
    v("min_overlap", self.min_overlap, "", "minimum share of the new place's points that overlap",
      between(0, 1));
    v("min_constraint", self.min_constraint, "",
      "minimum share of the least constrained direction in the information of all points (planes "
      "only)",
      between(0, 1));
    v("translation_drift_m_per_m", self.translation_drift_m_per_m, "m/m",
      "sigma of the odometry's drift in translation; a loop that corrects more than `drift_gate` "
      "sigmas is rejected; 0: no limit",
      at_least(0));
    v("rotation_drift_rad_per_m", self.rotation_drift_rad_per_m, "rad/m",
      "sigma of the odometry's drift in rotation", at_least(0));
    v("drift_gate", self.drift_gate, "sigma", "maximum correction by a loop", above(0));
    v("min_consistent_loops", self.min_consistent_loops, "",
      "number of loops with the same correction that are required to accept them", at_least(1));
    v("consistency_translation_m", self.consistency_translation_m, "m",
      "maximum difference in translation of loops that agree", above(0));
    v("consistency_rotation_rad", self.consistency_rotation_rad, "rad",
      "maximum difference in rotation of loops that agree", above(0));
    v("odometry_translation_sigma_m", self.odometry_translation_sigma_m, "m",
      "sigma of the translation from keyframe to keyframe", above(0));
    v("odometry_rotation_sigma_rad", self.odometry_rotation_sigma_rad, "rad",
      "sigma of the rotation from keyframe to keyframe", above(0));
    v("loop_translation_sigma_m", self.loop_translation_sigma_m, "m",
      "sigma of the translation of a loop; 0: its fitness is the variance of both, in m^2 and "
      "rad^2",
      at_least(0));
    v("loop_rotation_sigma_rad", self.loop_rotation_sigma_rad, "rad",
      "sigma of the rotation of a loop", at_least(0));
    v("robust_kernel_scale", self.robust_kernel_scale, "sigma",
      "scale of the Cauchy kernel of loops; 0: no robust kernel", at_least(0));
  }
};

/// Our own settings (not those of LIO-SAM): candidates by distance and by appearance, verified by
/// overlap, fitness and the possible drift of the odometry, and accepted only if two agree.
LoopConfig conservative_loops();

constexpr auto enum_names(IcpMetric) {
  return std::array{std::pair{"points", IcpMetric::kPoints},
                    std::pair{"planes", IcpMetric::kPlanes}};
}

}  // namespace lidarena::loop
