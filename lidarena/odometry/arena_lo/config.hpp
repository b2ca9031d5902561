// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/base/config.hpp"
#include "lidarena/base/rig.hpp"
#include "lidarena/odometry/plane_map_config.hpp"
#include "lidarena/odometry/tracking.hpp"

namespace lidarena::odometry::arena_lo {

struct Config {
  double min_range_m = 0.1;
  double max_range_m = 100.0;
  double slice_s = 0.005;
  double scan_voxel_size_m = 0.1;
  int max_scan_points = 12000;

  PlaneMapConfig map{.cell_size_m = 0.2};

  int max_passes = 2;
  double first_kernel_scale_m = 0.2;
  double kernel_scale_m = 0.05;
  double point_variance_m2 = 4e-4;  // (2 cm)^2 of the data sheets
  TrackingConfig tracking;

  double acceleration_m_s2 = 3.0;
  double acceleration_time_s = 0.3;
  double angular_acceleration_rad_s2 = 15.0;
  double angular_acceleration_time_s = 0.1;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("min_range_m", self.min_range_m, "m", "nearer points are dropped", at_least(0));
    v("max_range_m", self.max_range_m, "m", "farther points are dropped", above(0));
    v("slice_s", self.slice_s, "s",
      "longest duration of a slice, the part of a scan that has a pose of its own", above(0));
    v("scan_voxel_size_m", self.scan_voxel_size_m, "m",
      "voxel size in which a slice's points are averaged", above(0));
    v("max_scan_points", self.max_scan_points, "",
      "upper limit on the averages of all slices of a scan, taken evenly from all; bounds the time "
      "of a scan",
      at_least(100));
    PlaneMapConfig::visit(self.map, v);
    v("max_passes", self.max_passes, "",
      "maximum number of passes over a scan with the kernel's final scale", at_least(1));
    v("first_kernel_scale_m", self.first_kernel_scale_m, "m",
      "scale of the kernel in the first pass, halved from pass to pass; wider for points of which "
      "the position is less certain",
      above(0));
    v("kernel_scale_m", self.kernel_scale_m, "m",
      "distance from its plane at which a point has a quarter of its weight", above(0));
    v("point_variance_m2", self.point_variance_m2, "m^2",
      "variance of a point's distance from its plane; that of the plane's points if it is larger",
      above(0));
    TrackingConfig::visit(self.tracking, v);
    v("acceleration_m_s2", self.acceleration_m_s2, "m/s^2",
      "standard deviation of the acceleration along each axis", above(0));
    v("acceleration_time_s", self.acceleration_time_s, "s",
      "time over which the correlation of the acceleration falls to 1/e", above(0));
    v("angular_acceleration_rad_s2", self.angular_acceleration_rad_s2, "rad/s^2",
      "standard deviation of the angular acceleration about each axis", above(0));
    v("angular_acceleration_time_s", self.angular_acceleration_time_s, "s",
      "time over which the correlation of the angular acceleration falls to 1/e", above(0));
  }
};

/// The settings for `lidar`: its range limits, and a map of 1.5 times its maximum range.
Config settings_for(const LidarInfo& lidar);

}  // namespace lidarena::odometry::arena_lo
