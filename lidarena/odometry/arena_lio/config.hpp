// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/base/config.hpp"
#include "lidarena/base/rig.hpp"

namespace lidarena::odometry::arena_lio {

struct Config {
  double min_range_m = 0.3;
  double scan_voxel_size_m = 0.2;
  int max_scan_points = 4000;
  double map_voxel_size_m = 0.2;
  double map_radius_m = 150.0;

  int max_iterations = 3;
  double point_variance_m2 = 4e-4;  // (2 cm)^2 of the data sheets; the plane's variance is added
  double max_neighbor_distance_m = 2.236;
  double max_plane_thickness_m = 0.1;
  double min_inlier_share = 0.75;
  bool estimate_extrinsics = false;

  double imu_noise_factor = 10.0;
  double max_imu_gap_s = 0.05;

  /// Former names, for the message that names the new one.
  static constexpr RenamedKey renamed_keys[] = {{"scan_voxel_m", "scan_voxel_size_m"},
                                                {"map_voxel_m", "map_voxel_size_m"},
                                                {"max_points", "max_scan_points"},
                                                {"max_neighbour_m", "max_neighbor_distance_m"},
                                                {"plane_thickness_m", "max_plane_thickness_m"},
                                                {"least_agreement", "min_inlier_share"}};

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("min_range_m", self.min_range_m, "m", "nearer points are dropped", at_least(0));
    v("scan_voxel_size_m", self.scan_voxel_size_m, "m",
      "voxel size in which a scan's points are averaged", above(0));
    v("max_scan_points", self.max_scan_points, "",
      "upper limit on the averaged points of a scan, taken evenly from all; bounds the time of a "
      "scan",
      at_least(100));
    v("map_voxel_size_m", self.map_voxel_size_m, "m",
      "voxel size of the map, which keeps one point per cell", above(0));
    v("map_radius_m", self.map_radius_m, "m",
      "half the edge of the box around the sensor outside of which map points are removed",
      above(0));
    v("max_iterations", self.max_iterations, "",
      "maximum number of iterations of the filter's update", at_least(0));
    v("point_variance_m2", self.point_variance_m2, "m^2",
      "variance of a point's distance from its plane, without the plane's own", above(0));
    v("max_neighbor_distance_m", self.max_neighbor_distance_m, "m",
      "maximum distance of the fifth neighbor", above(0));
    v("max_plane_thickness_m", self.max_plane_thickness_m, "m",
      "maximum distance of a neighbor from the plane fitted to all", above(0));
    v("min_inlier_share", self.min_inlier_share, "",
      "a scan is not added to the map when a smaller share of its points near planes lies on them; "
      "after fifteen such scans in a row the status is diverged",
      between(0, 1));
    v("estimate_extrinsics", self.estimate_extrinsics, "",
      "also estimate the LiDAR's pose relative to the IMU");
    v("imu_noise_factor", self.imu_noise_factor, "",
      "factor on the data sheet's densities: covers vibration and errors that the planes do not "
      "show",
      above(0));
    v("max_imu_gap_s", self.max_imu_gap_s, "s",
      "over a longer gap between IMU samples the motion is coasted, with large noise", above(0));
  }
};

/// The settings for `lidar`: its range limits.
Config settings_for(const LidarInfo& lidar);

}  // namespace lidarena::odometry::arena_lio
