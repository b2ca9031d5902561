// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "lidarena/base/config.hpp"
#include "lidarena/world/world_model.hpp"

namespace lidarena::scenes {

/// A story of an office building: two long equal corridors, joined at their ends around a core with
/// glass fronts, offices of one plan along both, and a staircase at one corner.
struct OfficeConfig {
  int offices = 10;
  double office_width_m = 3.6;
  double office_depth_m = 4.5;
  double corridor_m = 2.2;
  double core_m = 5;
  double height_m = 2.8;
  double open_doors = 0.6;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("offices", self.offices, "", "offices along each corridor", between(3, 40));
    v("office_width_m", self.office_width_m, "m", "width of an office", between(3, 6));
    v("office_depth_m", self.office_depth_m, "m", "depth of an office", between(3.5, 8));
    v("corridor_m", self.corridor_m, "m", "clear width of the corridors", between(2, 4));
    v("core_m", self.core_m, "m", "distance between the corridors", between(3, 12));
    v("height_m", self.height_m, "m", "height of the rooms", between(2.5, 4));
    v("open_doors", self.open_doors, "", "share of the doors that stand open", between(0, 1));
  }
};

/// Returns the story with the floor at z = 0 and one closed route around the core; it keeps 0.7 m
/// from everything, and every ray from it hits a surface. The same (config, seed) give
/// bit-identical results.
world::WorldModel make_office(const OfficeConfig& config, std::uint64_t seed);

}  // namespace lidarena::scenes
