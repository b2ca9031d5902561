// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/base/config.hpp"
#include "lidarena/base/rig.hpp"
#include "lidarena/odometry/plane_map_config.hpp"
#include "lidarena/odometry/tracking.hpp"

namespace lidarena::odometry::arena_lio {

struct Config {
  double min_range_m = 0.3;
  double scan_voxel_size_m = 0.2;
  int max_scan_points = 4000;
  PlaneMapConfig map;

  int max_iterations = 3;
  double point_variance_m2 = 4e-4;  // (2 cm)^2 of the data sheets; the plane's variance is added
  double kernel_scale_m = 0.05;
  TrackingConfig tracking;
  bool estimate_extrinsics = true;

  bool calibrate_gyro = true;
  double gyro_noise_factor = 10.0;
  double accel_noise_factor = 3.0;
  double max_imu_gap_s = 0.05;
  double max_slice_error_m = 1e-4;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("min_range_m", self.min_range_m, "m", "nearer points are dropped", at_least(0));
    v("scan_voxel_size_m", self.scan_voxel_size_m, "m",
      "voxel size in which a scan's points are averaged", above(0));
    v("max_scan_points", self.max_scan_points, "",
      "upper limit on the averaged points of a scan, taken evenly from all; bounds the time of a "
      "scan",
      at_least(100));
    PlaneMapConfig::visit(self.map, v);
    v("max_iterations", self.max_iterations, "",
      "maximum number of iterations of the filter's update", at_least(0));
    v("point_variance_m2", self.point_variance_m2, "m^2",
      "variance of a point's distance from its plane, without the plane's own", above(0));
    v("kernel_scale_m", self.kernel_scale_m, "m",
      "distance from its plane at which a point has a quarter of its weight", above(0));
    TrackingConfig::visit(self.tracking, v);
    v("estimate_extrinsics", self.estimate_extrinsics, "",
      "also estimate the LiDAR's pose relative to the IMU; the body stays where the LiDAR is told "
      "to be on it");
    v("calibrate_gyro", self.calibrate_gyro, "",
      "also estimate the gyro's scale factors, the misalignment of its axes and the delay of its "
      "clock");
    v("gyro_noise_factor", self.gyro_noise_factor, "",
      "factor on the data sheet's densities of the gyro: covers vibration and what is not "
      "calibrated",
      above(0));
    v("accel_noise_factor", self.accel_noise_factor, "",
      "factor on the data sheet's densities of the accelerometer", above(0));
    v("max_imu_gap_s", self.max_imu_gap_s, "s",
      "over a longer gap between IMU samples the motion is coasted, with large noise", above(0));
    v("max_slice_error_m", self.max_slice_error_m, "m",
      "a scan is registered in slices within which the accelerometer's noise moves the position by "
      "less than this, at most eight",
      above(0));
  }
};

/// The settings for `lidar`: its range limits.
Config settings_for(const LidarInfo& lidar);

}  // namespace lidarena::odometry::arena_lio
