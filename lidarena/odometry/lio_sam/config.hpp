// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "lidarena/base/config.hpp"
#include "lidarena/base/rig.hpp"
#include "lidarena/estimation/plane_fit.hpp"
#include "lidarena/loop/config.hpp"
#include "lidarena/map/grid_axes.hpp"

namespace lidarena::lio_sam {

/// What a column of the range image is.
enum class Columns {
  kAzimuth,  ///< a direction: the first point of each cell stays
  kArrival,  ///< a place in the order of firing within the ring: for patterns that do not repeat
};

/// What a direction must have to be updated by the scan.
enum class Degeneracy {
  kEigenvalue,  ///< an eigenvalue of at least 100, whatever the number of points
  kShare,       ///< a share of all that the points tell, turning and shifting on one scale
};

/// The defaults are those of the public program with its advice for rooms; preset() changes them.
struct Config {
  double process_interval_s = 0.15;

  Columns columns_by = Columns::kAzimuth;
  int columns = 1800;
  int row_stride = 1;
  double min_range_m = 1.0;
  double max_range_m = 1000.0;

  bool deskew_translation = false;
  bool deskew_bias = false;

  int smoothness_neighbors = 5;
  double edge_threshold_m2 = 1.0;
  int edges_per_sector = 20;
  int occluded_points = 6;
  double grazing_share = 0.02;
  double edge_leaf_m = 0.1;
  double surface_leaf_m = 0.2;
  GridAxes grid_axes = GridAxes::kParallel;

  int min_edges = 10;
  int min_surfaces = 100;
  int max_iterations = 30;
  double turn_tolerance_rad = 8.7e-4;
  double shift_tolerance_m = 5e-4;
  double search_step_m = 0.0;
  PlaneFit plane_fit = PlaneFit::kUnitOffset;
  double plane_thickness_m = 0.2;
  Degeneracy degeneracy = Degeneracy::kEigenvalue;

  double keyframe_distance_m = 1.0;
  double keyframe_angle_rad = 0.2;
  double keyframe_age_s = 0.0;
  int scans_per_keyframe = 1;
  double submap_radius_m = 50.0;
  double submap_density_m = 2.0;
  double submap_recent_s = 10.0;

  bool level_start = false;
  double gravity = 9.80511;
  double gravity_sigma_rad = 0.0;
  double imu_noise_factor = 0.0;
  double gyro_noise = 1.5636343949698187e-3;
  double accel_noise = 3.9939570888238808e-3;
  double gyro_walk = 3.5640318696367613e-5;
  double accel_walk = 6.4356659353532566e-5;
  double max_imu_gap_s = 0.05;
  double turn_sigma_rad = 0.05;
  double shift_sigma_m = 0.1;
  double point_sigma_m = 0.0;
  bool fused_pose = false;

  bool loop_closure = false;
  LoopConfig loop;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("process_interval_s", self.process_interval_s, "s",
      "scans that begin sooner after the last one are predicted only; 0: every scan is used (cure)",
      at_least(0));
    v("columns_by", self.columns_by, "", "azimuth, or arrival for patterns that do not repeat");
    v("columns", self.columns, "", "of the range image; with azimuth", at_least(16));
    v("row_stride", self.row_stride, "", "of this many rows, one is used", at_least(1));
    v("min_range_m", self.min_range_m, "m", "nearer points are dropped", at_least(0));
    v("max_range_m", self.max_range_m, "m", "farther points are dropped", above(0));
    v("deskew_translation", self.deskew_translation, "",
      "cure: points are moved by the body's shift within the scan too, not by its turn alone");
    v("deskew_bias", self.deskew_bias, "", "cure: by the turn without the gyro's bias");
    v("smoothness_neighbors", self.smoothness_neighbors, "",
      "on each side, that a point's range is compared with", at_least(1));
    v("edge_threshold_m2", self.edge_threshold_m2, "m^2", "rougher points may be edges", above(0));
    v("edges_per_sector", self.edges_per_sector, "", "a sector is a sixth of a row", at_least(0));
    v("occluded_points", self.occluded_points, "", "barred on the far side of a jump", at_least(0));
    v("grazing_share", self.grazing_share, "",
      "points whose range differs from both neighbors' by more than this share are barred",
      above(0));
    v("edge_leaf_m", self.edge_leaf_m, "m", "edges are averaged in cells of this edge", above(0));
    v("surface_leaf_m", self.surface_leaf_m, "m", "surface points likewise", above(0));
    v("grid_axes", self.grid_axes, "",
      "of those cells: parallel to the LiDAR's frame and the world, or askew (cure: walls are not "
      "parallel to them)");
    v("min_edges", self.min_edges, "", "a scan with fewer is not registered", at_least(0));
    v("min_surfaces", self.min_surfaces, "", "likewise", at_least(0));
    v("max_iterations", self.max_iterations, "", "of Gauss-Newton", at_least(1));
    v("turn_tolerance_rad", self.turn_tolerance_rad, "rad", "a smaller step has converged",
      above(0));
    v("shift_tolerance_m", self.shift_tolerance_m, "m", "likewise", above(0));
    v("search_step_m", self.search_step_m, "m",
      "after a smaller step the correspondences stay; 0: searched in each iteration", at_least(0));
    v("plane_fit", self.plane_fit, "", "unit_offset or, not in the published program, principal");
    v("plane_thickness_m", self.plane_thickness_m, "m",
      "distance of each neighbor from their plane, at most", above(0));
    v("degeneracy", self.degeneracy, "", "eigenvalue or share (cure)");
    v("keyframe_distance_m", self.keyframe_distance_m, "m", "moved so far, a scan is a keyframe",
      above(0));
    v("keyframe_angle_rad", self.keyframe_angle_rad, "rad", "turned so far, likewise", above(0));
    v("keyframe_age_s", self.keyframe_age_s, "s",
      "a scan is a keyframe when the last one is older, moved or not; 0: never (cure)",
      at_least(0));
    v("scans_per_keyframe", self.scans_per_keyframe, "",
      "cure: so many of the scans up to the next keyframe are averaged into it, at most",
      at_least(1));
    v("submap_radius_m", self.submap_radius_m, "m", "keyframes this near are matched with",
      above(0));
    v("submap_density_m", self.submap_density_m, "m", "one of them in cells of this edge",
      above(0));
    v("submap_recent_s", self.submap_recent_s, "s", "and all that are not older", at_least(0));
    v("level_start", self.level_start, "",
      "cure: the start's roll and pitch are felt by the accelerometer; else they are zero");
    v("gravity", self.gravity, "m/s^2", "", above(0));
    v("gravity_sigma_rad", self.gravity_sigma_rad, "rad",
      "of gravity's direction in the world at a start at rest, estimated on; 0: known, straight "
      "down",
      at_least(0));
    v("imu_noise_factor", self.imu_noise_factor, "",
      "on the data sheet's densities (cure); 0: the four below", at_least(0));
    v("gyro_noise", self.gyro_noise, "rad/s/sqrt(Hz)", "", above(0));
    v("accel_noise", self.accel_noise, "m/s^2/sqrt(Hz)", "", above(0));
    v("gyro_walk", self.gyro_walk, "rad/s^2/sqrt(Hz)", "of the bias", at_least(0));
    v("accel_walk", self.accel_walk, "m/s^3/sqrt(Hz)", "of the bias", at_least(0));
    v("max_imu_gap_s", self.max_imu_gap_s, "s",
      "over a longer gap the motion is coasted, with a large noise", above(0));
    v("turn_sigma_rad", self.turn_sigma_rad, "rad", "of a scan's attitude beside the IMU, at least",
      above(0));
    v("shift_sigma_m", self.shift_sigma_m, "m", "of a scan's position, at least", above(0));
    v("point_sigma_m", self.point_sigma_m, "m",
      "of a point's distance: what the points leave open is left to the IMU (cure); 0: the two "
      "sigmas above are all, 1 rad and 1 m when a direction is degenerate",
      at_least(0));
    v("fused_pose", self.fused_pose, "",
      "cure: a scan's pose is the smoother's, of points and IMU together; else the points' alone");
    v("loop_closure", self.loop_closure, "", "whether loops are looked for");
    v("loop", self.loop, "", "how they are found, judged and used");
  }
};

/// Names of preset(), the default first.
std::vector<std::string> preset_names();

/// Settings for a LiDAR: "improved"; "original", the public program, for Livox sensors its port to
/// the Mid-360 with a 6-axis IMU. Throws InputError for another name.
Config preset(const std::string& name, const LidarInfo& lidar);

}  // namespace lidarena::lio_sam

namespace lidarena {

template <>
struct EnumNames<lio_sam::Columns> {
  static constexpr std::array names{std::pair{"azimuth", lio_sam::Columns::kAzimuth},
                                    std::pair{"arrival", lio_sam::Columns::kArrival}};
};

template <>
struct EnumNames<lio_sam::Degeneracy> {
  static constexpr std::array names{std::pair{"eigenvalue", lio_sam::Degeneracy::kEigenvalue},
                                    std::pair{"share", lio_sam::Degeneracy::kShare}};
};

}  // namespace lidarena
