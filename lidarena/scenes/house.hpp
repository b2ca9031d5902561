// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "lidarena/base/config.hpp"
#include "lidarena/world/world_model.hpp"

namespace lidarena::scenes {

/// A furnished one-story house of seven rooms, two of which (living room and hall) may be open over
/// two stories. The seed determines the positions of inner walls and doors and the shapes and
/// positions of the furniture.
struct HouseConfig {
  double width_m = 16;
  double depth_m = 10.4;
  double story_height_m = 2.7;
  double wall_thickness_m = 0.15;
  double door_width_m = 0.9;
  double door_height_m = 2.05;
  double passage_width_m = 0;
  bool high_rooms = true;
  double furnishing = 1;
  bool panes = true;
  bool ceilings = true;
  double variation_m = 0.25;
  bool symmetric = false;
  double detail = 1;

  /// Former names, for the message that names the new one.
  static constexpr RenamedKey renamed_keys[] = {
      {"storey_m", "story_height_m"}, {"wall_m", "wall_thickness_m"}, {"vary_m", "variation_m"}};

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("width_m", self.width_m, "m", "length of the house along x", between(15, 24));
    v("depth_m", self.depth_m, "m", "length of the house along y", between(10, 16));
    v("story_height_m", self.story_height_m, "m", "height of a story", between(2.5, 3.2));
    v("wall_thickness_m", self.wall_thickness_m, "m", "thickness of walls", between(0.1, 0.2));
    v("door_width_m", self.door_width_m, "m", "clear width of the doors", between(0.86, 0.9));
    v("door_height_m", self.door_height_m, "m", "clear height of the doors", between(2, 2.2));
    v("passage_width_m", self.passage_width_m, "m",
      "instead of doors, passages as high as the rooms less 0.3 m, up to this wide where the wall "
      "is long enough, so that rooms see one another; 0 = doors",
      between(0, 2.4));
    v("high_rooms", self.high_rooms, "",
      "living room, with a gallery, and hall are two stories high");
    v("furnishing", self.furnishing, "", "share of the furniture that is there", between(0, 1));
    v("panes", self.panes, "",
      "close the windows with glass panes; otherwise rays leave the house through them");
    v("ceilings", self.ceilings, "",
      "false: rooms are open to the sky, and nothing hangs from a ceiling");
    v("variation_m", self.variation_m, "m", "maximum random displacement of inner walls and doors",
      between(0, 0.3));
    v("symmetric", self.symmetric, "",
      "rooms and doors of the western half are the mirror image of those of the eastern one, but "
      "for "
      "the door from the living room to the hall; variation_m has no effect");
    v("detail", self.detail, "", "factor on the number of facets around each curved part",
      between(0.2, 3));
  }
};

/// The house covers [0, width] x [0, depth] (center lines of the outer walls), floor at z = 0. Its
/// one route is closed (the last point equals the first) and passes through every room and every
/// door, straight from 0.8 m before the door to 0.8 m behind it. It keeps 0.5 m from furniture and
/// 0.4 m from door posts. With panes and ceilings, every ray from inside hits a surface. The same
/// (config, seed) give bit-identical results.
world::WorldModel make_house(const HouseConfig& config, std::uint64_t seed);

}  // namespace lidarena::scenes
