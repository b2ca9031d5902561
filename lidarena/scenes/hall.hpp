// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "lidarena/base/config.hpp"
#include "lidarena/world/world_model.hpp"

namespace lidarena::scenes {

/// A large hall with a high roof on trusses: rows of racks with goods, which look alike, between
/// aisles, and a transverse aisle at either end.
struct HallConfig {
  int rows = 7;
  double length_m = 50;
  double height_m = 9;
  double aisle_m = 3;
  int levels = 3;
  double filling = 0.75;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("rows", self.rows, "", "rows of racks; odd, so that the aisles are a round trip",
      between(1, 21));
    v("length_m", self.length_m, "m", "length of the hall", between(25, 150));
    v("height_m", self.height_m, "m", "height of the walls", between(5, 15));
    v("aisle_m", self.aisle_m, "m", "clear width of an aisle", between(2.4, 6));
    v("levels", self.levels, "", "shelves of a rack, 1.6 m apart", between(1, 5));
    v("filling", self.filling, "", "share of the places with goods", between(0, 1));
  }
};

/// Returns the hall with the floor at z = 0 and one closed route along all aisles; it keeps 1 m
/// from everything, and every ray from it hits a surface. The same (config, seed) give
/// bit-identical results. Throws InputError when the number of rows is even, or the racks are
/// higher than the hall.
world::WorldModel make_hall(const HallConfig& config, std::uint64_t seed);

}  // namespace lidarena::scenes
