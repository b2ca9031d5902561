// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/base/config.hpp"
#include "lidarena/map/local_planes.hpp"

namespace lidarena::odometry {

/// The map of planes of arena_lo and arena_lio. Its keys are listed among those of the method.
struct PlaneMapConfig {
  double cell_size_m = 0.3;
  int max_cell_points = 400;
  double radius_m = 150.0;

  map::LocalPlanes::Options options() const { return {cell_size_m, max_cell_points, radius_m}; }

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("map_cell_size_m", self.cell_size_m, "m",
      "edge of a cell of the map, which has one plane for each side it is seen from; where there "
      "are few planes, cells of three times this edge are used",
      above(0));
    v("max_cell_points", self.max_cell_points, "",
      "points after which a cell of the map does not change any more", at_least(10));
    v("map_radius_m", self.radius_m, "m",
      "half the edge of the box around the sensor outside of which cells are removed", above(0));
  }
};

}  // namespace lidarena::odometry
