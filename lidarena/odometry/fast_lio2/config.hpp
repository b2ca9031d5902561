// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "lidarena/base/config.hpp"
#include "lidarena/base/rig.hpp"
#include "lidarena/estimation/plane_fit.hpp"
#include "lidarena/map/grid_axes.hpp"

namespace lidarena::odometry::fast_lio2 {

/// Source of the IMU's noise.
enum class NoiseModel {
  kPerSample,  ///< fixed covariances of a sample, so the filter depends on the IMU's rate
  kDensity,    ///< continuous densities of the data sheet times `imu_noise_factor`
};

/// The defaults are the published program's; preset() changes them.
struct Config {
  int point_stride = 3;
  double min_range_m = 0.5;
  bool deskew_first_instant = false;
  double scan_voxel_size_m = 0.5;
  map::GridAxes grid_axes = map::GridAxes::kParallel;
  int max_scan_points = 100000;
  double map_voxel_size_m = 0.5;

  int max_iterations = 3;
  double convergence = 1e-3;
  double point_variance_m2 = 1e-3;
  double max_neighbor_distance_m = 2.236;
  double max_plane_thickness_m = 0.1;
  estimation::PlaneFit plane_fit = estimation::PlaneFit::kUnitOffset;
  bool plane_uncertainty = false;
  bool estimate_extrinsics = false;

  NoiseModel noise_model = NoiseModel::kPerSample;
  double gyro_variance = 0.1;
  double accel_variance = 0.1;
  double gyro_bias_variance = 1e-4;
  double accel_bias_variance = 1e-4;
  double imu_noise_factor = 1.0;
  bool second_order_integration = false;
  double max_imu_gap_s = 0.05;
  bool detect_saturation = false;
  double min_inlier_share = 0.0;

  int initialization_samples = 10;
  bool skip_first_scan = true;
  bool always_scale_accel = true;
  double gravity = 9.81;
  double initial_sigma = 1.0;

  double map_radius_m = 500.0;
  bool keep_all_scans = true;
  bool zero_velocity_updates = false;
  int standing_scans_mapped = 20;
  bool hold_first_pose = false;

  /// Former names, for the message that names the new one.
  static constexpr RenamedKey renamed_keys[] = {{"scan_voxel_m", "scan_voxel_size_m"},
                                                {"map_voxel_m", "map_voxel_size_m"},
                                                {"max_points", "max_scan_points"},
                                                {"max_neighbour_m", "max_neighbor_distance_m"},
                                                {"plane_thickness_m", "max_plane_thickness_m"},
                                                {"second_order", "second_order_integration"},
                                                {"tell_clipping", "detect_saturation"},
                                                {"least_agreement", "min_inlier_share"},
                                                {"init_samples", "initialization_samples"},
                                                {"zero_velocity", "zero_velocity_updates"},
                                                {"still_scans_mapped", "standing_scans_mapped"}};

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("point_stride", self.point_stride, "", "every n-th point of a scan is used", at_least(1));
    v("min_range_m", self.min_range_m, "m", "nearer points are dropped", at_least(0));
    v("deskew_first_instant", self.deskew_first_instant, "",
      "also de-skew the points of the scan's first instant, when a spinning sensor fires a whole "
      "column; the published program leaves them unchanged");
    v("scan_voxel_size_m", self.scan_voxel_size_m, "m",
      "voxel size in which a scan's points are averaged", above(0));
    v("grid_axes", self.grid_axes, "",
      "axes of the scan's grid in the LiDAR's frame and of the map's in the world: parallel, or "
      "rotated, which keeps walls from being parallel to the cells (not in the published program)");
    v("max_scan_points", self.max_scan_points, "",
      "upper limit on the averaged points of a scan, taken evenly from all; bounds the time of a "
      "scan",
      at_least(100));
    v("map_voxel_size_m", self.map_voxel_size_m, "m",
      "voxel size of the map, which keeps one point per cell", above(0));
    v("max_iterations", self.max_iterations, "",
      "maximum number of iterations of the filter's update", at_least(0));
    v("convergence", self.convergence, "m, rad, m/s, ...", "largest step of a converged update",
      above(0));
    v("point_variance_m2", self.point_variance_m2, "m^2",
      "variance of a point's distance from its plane", above(0));
    v("max_neighbor_distance_m", self.max_neighbor_distance_m, "m",
      "maximum distance of the fifth neighbor", above(0));
    v("max_plane_thickness_m", self.max_plane_thickness_m, "m",
      "maximum distance of a neighbor from the plane fitted to all", above(0));
    v("plane_fit", self.plane_fit, "", "unit_offset, or principal (not in the published program)");
    v("plane_uncertainty", self.plane_uncertainty, "",
      "add the plane's variance to the point's (not in the published program); it is large when "
      "the five neighbors lie on a line");
    v("estimate_extrinsics", self.estimate_extrinsics, "",
      "also estimate the LiDAR's pose relative to the IMU");
    v("noise_model", self.noise_model, "", "per_sample, or density (not in the published program)");
    v("gyro_variance", self.gyro_variance, "(rad/s)^2", "variance of a sample, with per_sample",
      above(0));
    v("accel_variance", self.accel_variance, "(m/s^2)^2", "variance of a sample, with per_sample",
      above(0));
    v("gyro_bias_variance", self.gyro_bias_variance, "", "random walk per sample, with per_sample",
      at_least(0));
    v("accel_bias_variance", self.accel_bias_variance, "",
      "random walk per sample, with per_sample", at_least(0));
    v("imu_noise_factor", self.imu_noise_factor, "",
      "factor on the data sheet's densities, with density: covers vibration and errors that the "
      "planes do not show",
      above(0));
    v("second_order_integration", self.second_order_integration, "",
      "include a dt^2 / 2 in the position (not in the published program)");
    v("max_imu_gap_s", self.max_imu_gap_s, "s",
      "over a longer gap between IMU samples the motion is coasted, with large noise", above(0));
    v("detect_saturation", self.detect_saturation, "",
      "use large noise for IMU samples at the end of the measuring range (not in the published "
      "program)");
    v("min_inlier_share", self.min_inlier_share, "",
      "a scan is not added to the map when a smaller share of its points near planes lies on them; "
      "after fifteen such scans in a row the status is diverged; 0: never, as in the published "
      "program",
      between(0, 1));
    v("initialization_samples", self.initialization_samples, "",
      "number of IMU samples for the initialization", at_least(2));
    v("skip_first_scan", self.skip_first_scan, "", "do not use the first scan and its IMU samples");
    v("always_scale_accel", self.always_scale_accel, "",
      "scale accelerations so that their mean at the start equals gravity; false: only if they are "
      "in g (not in the published program)");
    v("gravity", self.gravity, "m/s^2", "magnitude of gravity", above(0));
    v("initial_sigma", self.initial_sigma, "m, rad, m/s",
      "sigma of position, attitude and velocity at the start; 0: position and attitude define the "
      "frame, and the velocity's sigma depends on whether the IMU shows rest (not in the published "
      "program)",
      at_least(0));
    v("map_radius_m", self.map_radius_m, "m",
      "half the edge of the box around the sensor outside of which map points are removed",
      above(0));
    v("keep_all_scans", self.keep_all_scans, "",
      "keep all points of all scans in memory, as the published program does for the file it "
      "writes at its end");
    v("zero_velocity_updates", self.zero_velocity_updates, "",
      "hold the velocity at zero while the IMU shows that the sensor stands still (not in the "
      "published program)");
    v("standing_scans_mapped", self.standing_scans_mapped, "",
      "maximum number of scans added to the map during a standstill; with zero_velocity_updates",
      at_least(1));
    v("hold_first_pose", self.hold_first_pose, "",
      "hold the first pose until the first motion, so that the map begins without drift; with "
      "zero_velocity_updates (not in the published program)");
  }
};

/// The program's own defaults.
Config published(const LidarInfo& lidar);
/// What a user of the program would set for a small sensor in rooms and tunnels.
Config indoor(const LidarInfo& lidar);

constexpr auto enum_names(NoiseModel) {
  return std::array{std::pair{"per_sample", NoiseModel::kPerSample},
                    std::pair{"density", NoiseModel::kDensity}};
}

}  // namespace lidarena::odometry::fast_lio2
