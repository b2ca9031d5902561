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

namespace lidarena::fast_lio2 {

/// Where the strength of the IMU's noise comes from.
enum class NoiseModel {
  kPerSample,  ///< fixed covariances of a sample, so the filter depends on the IMU's rate
  kDensity,    ///< continuous densities: the data sheet's, times `imu_noise_factor`
};

/// The defaults are the public program's; preset() changes them.
struct Config {
  int point_stride = 3;
  double min_range_m = 0.5;
  bool deskew_first_instant = false;
  double scan_voxel_m = 0.5;
  GridAxes grid_axes = GridAxes::kParallel;
  int max_points = 100000;
  double map_voxel_m = 0.5;

  int max_iterations = 3;
  double convergence = 1e-3;
  double point_variance_m2 = 1e-3;
  double max_neighbor_m = 2.236;
  double plane_thickness_m = 0.1;
  PlaneFit plane_fit = PlaneFit::kUnitOffset;
  bool plane_uncertainty = false;
  bool estimate_extrinsics = false;

  NoiseModel noise_model = NoiseModel::kPerSample;
  double gyro_variance = 0.1;
  double accel_variance = 0.1;
  double gyro_bias_variance = 1e-4;
  double accel_bias_variance = 1e-4;
  double imu_noise_factor = 1.0;
  bool second_order = false;
  double max_imu_gap_s = 0.05;
  bool tell_clipping = false;
  double least_agreement = 0.0;

  int init_samples = 10;
  bool skip_first_scan = true;
  bool always_scale_accel = true;
  double gravity = 9.81;
  double initial_sigma = 1.0;

  double map_radius_m = 500.0;
  bool keep_all_scans = true;
  bool zero_velocity = false;
  int still_scans_mapped = 20;
  bool hold_first_pose = false;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("point_stride", self.point_stride, "", "of this many points, one is used", at_least(1));
    v("min_range_m", self.min_range_m, "m", "nearer points are dropped", at_least(0));
    v("deskew_first_instant", self.deskew_first_instant, "",
      "cure: points of the scan's first instant are brought to its end like all others; a spinning "
      "sensor fires a whole column then");
    v("scan_voxel_m", self.scan_voxel_m, "m", "a scan's points are averaged in cells of this edge",
      above(0));
    v("grid_axes", self.grid_axes, "",
      "of the scan's cells in the LiDAR's frame and the map's in the world: parallel or askew "
      "(cure: walls are not parallel to them)");
    v("max_points", self.max_points, "",
      "of a scan's averages; from more, so many are taken evenly (bounds the time of a scan)",
      at_least(100));
    v("map_voxel_m", self.map_voxel_m, "m", "the map holds one point in a cell of this edge",
      above(0));
    v("max_iterations", self.max_iterations, "", "of the filter's update", at_least(0));
    v("convergence", self.convergence, "m, rad, m/s, ...", "largest step of a converged update",
      above(0));
    v("point_variance_m2", self.point_variance_m2, "m^2", "of a point across its plane", above(0));
    v("max_neighbor_m", self.max_neighbor_m, "m", "distance of the fifth neighbor, at most",
      above(0));
    v("plane_thickness_m", self.plane_thickness_m, "m",
      "distance of each neighbor from their plane, at most", above(0));
    v("plane_fit", self.plane_fit, "", "unit_offset or, not in the published program, principal");
    v("plane_uncertainty", self.plane_uncertainty, "",
      "cure: a point counts less the less its five neighbors say about their plane's place there, "
      "which is next to nothing when they lie on a line");
    v("estimate_extrinsics", self.estimate_extrinsics, "",
      "whether the LiDAR's place on the IMU is estimated, too");
    v("noise_model", self.noise_model, "", "per_sample or density (cure)");
    v("gyro_variance", self.gyro_variance, "(rad/s)^2", "of a sample; per_sample", above(0));
    v("accel_variance", self.accel_variance, "(m/s^2)^2", "of a sample; per_sample", above(0));
    v("gyro_bias_variance", self.gyro_bias_variance, "", "of a sample's walk; per_sample",
      at_least(0));
    v("accel_bias_variance", self.accel_bias_variance, "", "of a sample's walk; per_sample",
      at_least(0));
    v("imu_noise_factor", self.imu_noise_factor, "",
      "on the data sheet's densities: for vibration and for what the planes do not tell; density",
      above(0));
    v("second_order", self.second_order, "", "cure: the position takes half of a dt^2");
    v("max_imu_gap_s", self.max_imu_gap_s, "s",
      "over a longer gap the motion is coasted, with a large noise", above(0));
    v("tell_clipping", self.tell_clipping, "",
      "cure: over samples at the end of the IMU's range the noise is large");
    v("least_agreement", self.least_agreement, "",
      "cure: a scan of whose points near planes fewer than this share lie on them is not "
      "added to it; fifteen in a row: diverged; 0: never",
      between(0, 1));
    v("init_samples", self.init_samples, "", "IMU samples that the start is estimated from",
      at_least(2));
    v("skip_first_scan", self.skip_first_scan, "", "the first scan and its IMU samples are unused");
    v("always_scale_accel", self.always_scale_accel, "",
      "accelerations are scaled so that the start's mean is gravity; cure: only when they are in "
      "g");
    v("gravity", self.gravity, "m/s^2", "", above(0));
    v("initial_sigma", self.initial_sigma, "m, rad, m/s",
      "of position, attitude and velocity at the start; 0: none but the velocity's that the IMU "
      "shows (cure)",
      at_least(0));
    v("map_radius_m", self.map_radius_m, "m", "the map is forgotten beyond this", above(0));
    v("keep_all_scans", self.keep_all_scans, "",
      "all points of all scans stay in memory, as for the file that the program writes at its end");
    v("zero_velocity", self.zero_velocity, "",
      "cure: while the IMU shows that the sensor stands, its velocity is zero");
    v("still_scans_mapped", self.still_scans_mapped, "",
      "while it stands, only so many scans go into the map; with zero_velocity", at_least(1));
    v("hold_first_pose", self.hold_first_pose, "",
      "cure: until it first moves it is where it began, so that the map begins without drift; with "
      "zero_velocity");
  }
};

/// Names of preset(), the default first.
std::vector<std::string> preset_names();

/// Settings for a LiDAR: "improved"; "original", the public program of 2022 with its launch files.
/// Throws InputError for another name.
Config preset(const std::string& name, const LidarInfo& lidar);

}  // namespace lidarena::fast_lio2

namespace lidarena {

template <>
struct EnumNames<fast_lio2::NoiseModel> {
  static constexpr std::array names{std::pair{"per_sample", fast_lio2::NoiseModel::kPerSample},
                                    std::pair{"density", fast_lio2::NoiseModel::kDensity}};
};

}  // namespace lidarena
