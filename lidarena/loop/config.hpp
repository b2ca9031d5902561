// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/base/config.hpp"

namespace lidarena::loop {

/// Which loops are searched for and accepted. Candidates come by distance and by appearance; they
/// are verified by overlap, fit and the possible drift of the odometry, and accepted when two
/// agree to within their accuracy and the drift between them.
struct LoopConfig {
  double min_time_gap_s = 10.0;
  double min_path_length_m = 20.0;
  double search_radius_m = 10.0;
  int descriptor_candidates = 3;
  double descriptor_range_m = 30.0;
  double max_fitness_m2 = 0.01;
  double min_overlap = 0.7;
  double translation_drift_m_per_m = 0.02;
  double rotation_drift_rad_per_m = 0.002;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
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
    v("descriptor_range_m", self.descriptor_range_m, "m",
      "maximum range of the points in a place descriptor", above(0));
    v("max_fitness_m2", self.max_fitness_m2, "m^2",
      "maximum mean squared distance of corresponding points", above(0));
    v("min_overlap", self.min_overlap, "", "minimum share of the new place's points that overlap",
      between(0, 1));
    v("translation_drift_m_per_m", self.translation_drift_m_per_m, "m/m",
      "sigma of the odometry's drift in translation: weighs the odometry against loops, decides "
      "whether two loops agree, and a loop that corrects more than three sigmas is rejected",
      above(0));
    v("rotation_drift_rad_per_m", self.rotation_drift_rad_per_m, "rad/m",
      "sigma of the odometry's drift in rotation", above(0));
  }
};

}  // namespace lidarena::loop
