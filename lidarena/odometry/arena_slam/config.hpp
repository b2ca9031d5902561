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

namespace lidarena::odometry::arena_slam {

/// Meaning of a column of the range image.
enum class Columns {
  kAzimuth,  ///< an interval of azimuth; a cell keeps its first point
  kArrival,  ///< index in the firing order of the ring: for patterns that do not repeat
};

/// Condition on a direction to be updated by the scan; otherwise it is degenerate.
enum class Degeneracy {
  kEigenvalue,  ///< an eigenvalue of at least 100, regardless of the number of points
  kShare,       ///< a minimum share of all points' information, rotation scaled to translation
};

/// The defaults are those of the published program with its advice for rooms; preset() changes
/// them.
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
  double edge_voxel_size_m = 0.1;
  double surface_voxel_size_m = 0.2;
  map::GridAxes grid_axes = map::GridAxes::kParallel;

  int min_edges = 10;
  int min_surfaces = 100;
  int max_iterations = 30;
  double convergence_rotation_rad = 8.7e-4;
  double convergence_translation_m = 5e-4;
  double reassociation_distance_m = 0.0;
  estimation::PlaneFit plane_fit = estimation::PlaneFit::kUnitOffset;
  double max_plane_thickness_m = 0.2;
  Degeneracy degeneracy = Degeneracy::kEigenvalue;

  double keyframe_translation_m = 1.0;
  double keyframe_rotation_rad = 0.2;
  double keyframe_interval_s = 0.0;
  int scans_per_keyframe = 1;
  double submap_radius_m = 50.0;
  double submap_keyframe_spacing_m = 2.0;
  double submap_recent_s = 10.0;

  bool gravity_aligned_start = false;
  double gravity = 9.80511;
  double gravity_sigma_rad = 0.0;
  double imu_noise_factor = 0.0;
  double gyro_noise_density = 1.5636343949698187e-3;
  double accel_noise_density = 3.9939570888238808e-3;
  double gyro_bias_walk = 3.5640318696367613e-5;
  double accel_bias_walk = 6.4356659353532566e-5;
  double max_imu_gap_s = 0.05;
  double min_rotation_sigma_rad = 0.05;
  double min_translation_sigma_m = 0.1;
  double point_sigma_m = 0.0;
  bool smoothed_pose = false;

  bool loop_closure = false;
  loop::LoopConfig loop;

  /// Former names, for the message that names the new one.
  static constexpr RenamedKey renamed_keys[] = {{"smoothness_neighbours", "smoothness_neighbors"},
                                                {"edge_leaf_m", "edge_voxel_size_m"},
                                                {"surface_leaf_m", "surface_voxel_size_m"},
                                                {"turn_tolerance_rad", "convergence_rotation_rad"},
                                                {"shift_tolerance_m", "convergence_translation_m"},
                                                {"search_step_m", "reassociation_distance_m"},
                                                {"plane_thickness_m", "max_plane_thickness_m"},
                                                {"keyframe_distance_m", "keyframe_translation_m"},
                                                {"keyframe_angle_rad", "keyframe_rotation_rad"},
                                                {"keyframe_age_s", "keyframe_interval_s"},
                                                {"submap_density_m", "submap_keyframe_spacing_m"},
                                                {"level_start", "gravity_aligned_start"},
                                                {"gyro_noise", "gyro_noise_density"},
                                                {"accel_noise", "accel_noise_density"},
                                                {"gyro_walk", "gyro_bias_walk"},
                                                {"accel_walk", "accel_bias_walk"},
                                                {"turn_sigma_rad", "min_rotation_sigma_rad"},
                                                {"shift_sigma_m", "min_translation_sigma_m"},
                                                {"fused_pose", "smoothed_pose"}};

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("process_interval_s", self.process_interval_s, "s",
      "scans that begin sooner after the last processed one are only predicted; 0: every scan is "
      "used (not in the published program)",
      at_least(0));
    v("columns_by", self.columns_by, "",
      "azimuth, or arrival (firing order) for patterns that do not repeat");
    v("columns", self.columns, "", "number of columns of the range image, with azimuth",
      at_least(16));
    v("row_stride", self.row_stride, "", "every n-th row is used", at_least(1));
    v("min_range_m", self.min_range_m, "m", "nearer points are dropped", at_least(0));
    v("max_range_m", self.max_range_m, "m", "farther points are dropped", above(0));
    v("deskew_translation", self.deskew_translation, "",
      "also remove the body's translation within the scan, not only its rotation (the published "
      "program removes the rotation only)");
    v("deskew_bias", self.deskew_bias, "",
      "subtract the gyro's bias for de-skewing (not in the published program)");
    v("smoothness_neighbors", self.smoothness_neighbors, "",
      "number of neighbors on each side with which a point's range is compared", at_least(1));
    v("edge_threshold_m2", self.edge_threshold_m2, "m^2", "minimum roughness of an edge point",
      above(0));
    v("edges_per_sector", self.edges_per_sector, "",
      "upper limit on the edges of a sector, which is a sixth of a row", at_least(0));
    v("occluded_points", self.occluded_points, "",
      "number of points excluded as edges on the far side of a range jump", at_least(0));
    v("grazing_share", self.grazing_share, "",
      "points whose range differs from that of both neighbors by more than this share are excluded "
      "as edges",
      above(0));
    v("edge_voxel_size_m", self.edge_voxel_size_m, "m",
      "voxel size in which edge points are averaged", above(0));
    v("surface_voxel_size_m", self.surface_voxel_size_m, "m",
      "voxel size in which surface points are averaged", above(0));
    v("grid_axes", self.grid_axes, "",
      "axes of those grids: parallel to the LiDAR's frame and the world, or rotated, which keeps "
      "walls from being parallel to the cells (not in the published program)");
    v("min_edges", self.min_edges, "", "a scan with fewer edge points is not registered",
      at_least(0));
    v("min_surfaces", self.min_surfaces, "", "a scan with fewer surface points is not registered",
      at_least(0));
    v("max_iterations", self.max_iterations, "", "maximum number of Gauss-Newton iterations",
      at_least(1));
    v("convergence_rotation_rad", self.convergence_rotation_rad, "rad",
      "the registration has converged when its step is smaller in rotation ...", above(0));
    v("convergence_translation_m", self.convergence_translation_m, "m", "... and in translation",
      above(0));
    v("reassociation_distance_m", self.reassociation_distance_m, "m",
      "after a smaller step the correspondences are kept; 0: they are searched in each iteration",
      at_least(0));
    v("plane_fit", self.plane_fit, "", "unit_offset, or principal (not in the published program)");
    v("max_plane_thickness_m", self.max_plane_thickness_m, "m",
      "maximum distance of a neighbor from the plane fitted to all", above(0));
    v("degeneracy", self.degeneracy, "",
      "rule for degenerate directions: eigenvalue, or share (not in the published program)");
    v("keyframe_translation_m", self.keyframe_translation_m, "m",
      "a scan becomes a keyframe after this translation since the last one", above(0));
    v("keyframe_rotation_rad", self.keyframe_rotation_rad, "rad",
      "a scan becomes a keyframe after this rotation about an axis since the last one", above(0));
    v("keyframe_interval_s", self.keyframe_interval_s, "s",
      "a scan becomes a keyframe when the last one is older, even without motion; 0: never",
      at_least(0));
    v("scans_per_keyframe", self.scans_per_keyframe, "",
      "upper limit on the scans that are averaged into a keyframe; above 1: not in the published "
      "program",
      at_least(1));
    v("submap_radius_m", self.submap_radius_m, "m",
      "radius around the last keyframe within which keyframes enter the submap", above(0));
    v("submap_keyframe_spacing_m", self.submap_keyframe_spacing_m, "m",
      "edge of the cells from each of which the oldest keyframe enters the submap", above(0));
    v("submap_recent_s", self.submap_recent_s, "s",
      "all keyframes within the radius that are not older enter the submap too", at_least(0));
    v("gravity_aligned_start", self.gravity_aligned_start, "",
      "estimate roll and pitch at the start from the accelerometer; false: they are zero, as in "
      "the published program");
    v("gravity", self.gravity, "m/s^2", "magnitude of gravity", above(0));
    v("gravity_sigma_rad", self.gravity_sigma_rad, "rad",
      "sigma of gravity's direction in the world at a start at rest; the direction is then "
      "estimated. 0: known, straight down",
      at_least(0));
    v("imu_noise_factor", self.imu_noise_factor, "",
      "factor on the data sheet's noise densities (not in the published program); 0: the next four "
      "values are used",
      at_least(0));
    v("gyro_noise_density", self.gyro_noise_density, "rad/s/sqrt(Hz)", "noise density of the gyro",
      above(0));
    v("accel_noise_density", self.accel_noise_density, "m/s^2/sqrt(Hz)",
      "noise density of the accelerometer", above(0));
    v("gyro_bias_walk", self.gyro_bias_walk, "rad/s^2/sqrt(Hz)", "random walk of the gyro's bias",
      at_least(0));
    v("accel_bias_walk", self.accel_bias_walk, "m/s^3/sqrt(Hz)",
      "random walk of the accelerometer's bias", at_least(0));
    v("max_imu_gap_s", self.max_imu_gap_s, "s",
      "over a longer gap between IMU samples the motion is coasted, with large noise", above(0));
    v("min_rotation_sigma_rad", self.min_rotation_sigma_rad, "rad",
      "minimum sigma of a registered rotation in the smoother", above(0));
    v("min_translation_sigma_m", self.min_translation_sigma_m, "m",
      "minimum sigma of a registered position in the smoother", above(0));
    v("point_sigma_m", self.point_sigma_m, "m",
      "sigma of a point's distance, by which the smoother weights each direction of a registered "
      "pose by what the points determine (not in the published program); 0: the two minimum sigmas "
      "are used alone, 1 rad and 1 m when a direction is degenerate",
      at_least(0));
    v("smoothed_pose", self.smoothed_pose, "",
      "a scan's pose is the smoother's, from points and IMU together (not in the published "
      "program); false: it is that of the points alone");
    v("loop_closure", self.loop_closure, "", "whether loops are searched for");
    v("loop", self.loop, "", "how loop candidates are found, verified and used");
  }
};

/// The settings for `lidar`.
Config indoor(const LidarInfo& lidar);

constexpr auto enum_names(Columns) {
  return std::array{std::pair{"azimuth", Columns::kAzimuth},
                    std::pair{"arrival", Columns::kArrival}};
}

constexpr auto enum_names(Degeneracy) {
  return std::array{std::pair{"eigenvalue", Degeneracy::kEigenvalue},
                    std::pair{"share", Degeneracy::kShare}};
}

}  // namespace lidarena::odometry::arena_slam
