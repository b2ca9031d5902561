// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/base/config.hpp"
#include "lidarena/base/rig.hpp"

namespace lidarena::odometry::fast_lio2 {

/// The program's parameters, with its launch files' values for a spinning LiDAR.
struct Config {
  int point_stride = 4;
  double min_range_m = 0.5;
  double scan_voxel_size_m = 0.5;
  double map_voxel_size_m = 0.5;
  double map_box_size_m = 1000.0;
  double detection_range_m = 150.0;
  int max_iterations = 3;
  bool estimate_extrinsics = false;
  double gyro_variance = 0.1;
  double accel_variance = 0.1;
  double gyro_bias_variance = 1e-4;
  double accel_bias_variance = 1e-4;
  bool keep_all_scans = true;
  bool azimuth_times = false;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("point_stride", self.point_stride, "",
      "every n-th point of a scan is used (the program's point_filter_num)", at_least(1));
    v("min_range_m", self.min_range_m, "m", "nearer points are dropped (blind)", at_least(0));
    v("scan_voxel_size_m", self.scan_voxel_size_m, "m",
      "voxel size in which a scan's points are averaged (filter_size_surf)", above(0));
    v("map_voxel_size_m", self.map_voxel_size_m, "m",
      "voxel size of the map, which keeps one point per cell (filter_size_map)", above(0));
    v("map_box_size_m", self.map_box_size_m, "m", "edge of the map's box (cube_side_length)",
      above(0));
    v("detection_range_m", self.detection_range_m, "m",
      "the map's box moves when the sensor is within 1.5 times this of a face (det_range)",
      above(0));
    v("max_iterations", self.max_iterations, "",
      "maximum number of iterations of the filter's update (max_iteration)", at_least(0));
    v("estimate_extrinsics", self.estimate_extrinsics, "",
      "also estimate the LiDAR's pose relative to the IMU (extrinsic_est_en)");
    v("gyro_variance", self.gyro_variance, "(rad/s)^2", "of each IMU sample (gyr_cov)", above(0));
    v("accel_variance", self.accel_variance, "(m/s^2)^2", "of each IMU sample (acc_cov)", above(0));
    v("gyro_bias_variance", self.gyro_bias_variance, "(rad/s^2)^2",
      "random walk of the bias, of each IMU sample (b_gyr_cov)", at_least(0));
    v("accel_bias_variance", self.accel_bias_variance, "(m/s^3)^2",
      "random walk of the bias, of each IMU sample (b_acc_cov)", at_least(0));
    v("keep_all_scans", self.keep_all_scans, "",
      "count the memory of all points of all scans, which the program keeps for a file at the end "
      "(pcd_save_en)");
    v("azimuth_times", self.azimuth_times, "",
      "points of scans without times get times from their azimuth, as the program's input for a "
      "Velodyne makes them up (lidar_type 2); false: the scan is instantaneous");
  }
};

/// The program's launch files: that for a Livox or, for any other LiDAR, that for an Ouster, both
/// with the minimum range of the Mid-360.
Config published(const LidarInfo& lidar);
/// What its authors advise indoors: `published` with voxels of 0.2 m.
Config indoor(const LidarInfo& lidar);
/// The best of 32 settings of the program on flights of the development set (docs/results/tuning).
Config tuned(const LidarInfo& lidar);

}  // namespace lidarena::odometry::fast_lio2
