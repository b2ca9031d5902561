// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "lidarena/base/config.hpp"
#include "lidarena/world/world_model.hpp"

namespace lidarena {

/// A furnished one-story house of seven rooms, two of them (living room and hall) open over two
/// stories. The seed moves inner walls and doors and draws the furniture and where it stands.
struct HouseConfig {
  double width_m = 16;
  double depth_m = 10.4;
  double story_m = 2.7;
  double wall_m = 0.15;
  double door_width_m = 0.9;
  double door_height_m = 2.05;
  bool panes = true;
  double vary_m = 0.25;
  double detail = 1;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("width_m", self.width_m, "m", "length of the house along x", between(15, 24));
    v("depth_m", self.depth_m, "m", "length of the house along y", between(10, 16));
    v("story_m", self.story_m, "m", "height of a story; two rooms are twice as high",
      between(2.6, 3.2));
    v("wall_m", self.wall_m, "m", "thickness of walls", between(0.1, 0.2));
    v("door_width_m", self.door_width_m, "m", "clear width of the doors", between(0.86, 0.9));
    v("door_height_m", self.door_height_m, "m", "clear height of the doors", between(2, 2.2));
    v("panes", self.panes, "", "close the windows; otherwise rays leave through them");
    v("vary_m", self.vary_m, "m", "how far the seed moves inner walls and doors", between(0, 0.3));
    v("detail", self.detail, "", "scales the number of facets around each curved part",
      between(0.2, 3));
  }
};

/// The house stands on [0, width] x [0, depth] (outer walls' center lines), floor at z = 0. Its one
/// route is closed (the last point equals the first), passes every door straight between points
/// 0.8 m before and behind, and every room; it keeps 0.5 m from furniture and 0.4 m from door
/// posts. With panes, every ray from inside hits something. The same (config, seed) give the same
/// bits.
WorldModel make_house(const HouseConfig& config, std::uint64_t seed);

}  // namespace lidarena
