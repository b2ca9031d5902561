// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/base/config.hpp"

namespace lidarena::sensor {

/// Field of view according to a data sheet, in the lidar frame: the directions within a box of
/// azimuth (from x towards y) and elevation, and within a cone about x.
struct FieldOfView {
  double azimuth_min_deg = -180.0;
  double azimuth_max_deg = 180.0;
  double elevation_min_deg = -90.0;
  double elevation_max_deg = 90.0;
  double half_angle_deg = 180.0;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("azimuth_min_deg", self.azimuth_min_deg, "deg", "", between(-180, 180));
    v("azimuth_max_deg", self.azimuth_max_deg, "deg", "", between(-180, 180));
    v("elevation_min_deg", self.elevation_min_deg, "deg", "", between(-90, 90));
    v("elevation_max_deg", self.elevation_max_deg, "deg", "", between(-90, 90));
    v("half_angle_deg", self.half_angle_deg, "deg", "half angle of a cone about x; 180 = no cone",
      Limits{0.0, 180.0, true});
  }
};

}  // namespace lidarena::sensor
