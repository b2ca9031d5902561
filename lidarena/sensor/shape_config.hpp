// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "lidarena/base/config.hpp"
#include "lidarena/sensor/field_of_view.hpp"

namespace lidarena::sensor {

/// Changes one property of a scan pattern and leaves all others: to find out which one matters.
/// Each is off by default.
struct ShapeConfig {
  double shots_per_second = 0.0;
  double fov_height_deg = 0.0;
  double fov_shift_deg = 0.0;
  bool repetitive = false;
  std::optional<FieldOfView> clip;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("shots_per_second", self.shots_per_second, "Hz",
      "the lasers fire more or less often at the same turn rates of prisms and head: the same "
      "pattern with more or fewer shots, 0 = as many as the product",
      between(0, 1e8));
    v("fov_height_deg", self.fov_height_deg, "deg",
      "all shots in a field of view of this height: elevations are scaled about the middle of "
      "facts.fov, 0 = as they are",
      between(0, 180));
    v("fov_shift_deg", self.fov_shift_deg, "deg",
      "added to the elevation of each shot, after the scaling; positive upwards",
      between(-180, 180));
    v("repetitive", self.repetitive, "", "true: every scan has the shots of the first one");
    v("clip", self.clip, "",
      "only returns from directions within this field of view are reported; all shots are fired");
  }
};

/// Turns and moves a LiDAR in its mount.
struct MountConfig {
  double pitch_deg = 0.0;
  double yaw_deg = 0.0;
  double up_m = 0.0;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("pitch_deg", self.pitch_deg, "deg",
      "turns the LiDAR about the body's y axis: 90 = what looked forward looks down",
      between(-180, 180));
    v("yaw_deg", self.yaw_deg, "deg",
      "turns the LiDAR about the body's z axis, after the pitch: 90 = what looked forward looks "
      "left",
      between(-180, 180));
    v("up_m", self.up_m, "m", "moves the LiDAR along the body's z axis", between(-10, 10));
  }
};

}  // namespace lidarena::sensor
