// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <utility>

#include "lidarena/base/config.hpp"
#include "lidarena/base/rig.hpp"

namespace lidarena::odometry::lio_sam {

/// Which program is followed: they differ in the range image and the rules for edges.
enum class Sensor {
  kSpinning,  ///< LIO-SAM: columns of the range image are intervals of azimuth
  kLivox,     ///< its port to the Mid-360: columns are the firing order of each line
};

/// How loops are searched for and accepted.
struct LoopRule {
  double interval_s = 1.0;
  double search_radius_m = 15.0;
  double min_time_gap_s = 30.0;
  int target_keyframes = 25;
  double max_fitness_m2 = 0.3;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("interval_s", self.interval_s, "s", "minimum time from one search to the next", at_least(0));
    v("search_radius_m", self.search_radius_m, "m",
      "the nearest keyframe within this distance is a candidate", above(0));
    v("min_time_gap_s", self.min_time_gap_s, "s", "minimum time between the two visits of a place",
      at_least(0));
    v("target_keyframes", self.target_keyframes, "",
      "number of keyframes on each side of the old one whose points are matched", at_least(0));
    v("max_fitness_m2", self.max_fitness_m2, "m^2",
      "a loop is accepted below this mean squared distance of corresponding points", above(0));
  }
};

/// The defaults are those shipped for spinning LiDARs.
struct Config {
  double process_interval_s = 0.15;

  Sensor sensor = Sensor::kSpinning;
  int columns = 1800;
  int row_stride = 1;
  double min_range_m = 1.0;
  double max_range_m = 1000.0;

  double edge_threshold_m2 = 1.0;
  double row_surface_voxel_size_m = 0.4;
  double edge_voxel_size_m = 0.2;
  double surface_voxel_size_m = 0.4;
  int min_edges = 10;
  int min_surfaces = 100;

  double keyframe_translation_m = 1.0;
  double keyframe_rotation_rad = 0.2;
  double submap_radius_m = 50.0;
  double submap_keyframe_spacing_m = 2.0;

  double gravity = 9.80511;
  double gyro_noise_density = 1.5636343949698187e-3;
  double accel_noise_density = 3.9939570888238808e-3;
  double gyro_bias_walk = 3.5640318696367613e-5;
  double accel_bias_walk = 6.4356659353532566e-5;

  bool loop_closure = false;
  LoopRule loop;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("process_interval_s", self.process_interval_s, "s",
      "scans that begin sooner after the last processed one are only predicted", at_least(0));
    v("sensor", self.sensor, "",
      "spinning, or livox: the port to the Mid-360, with other rules for the range image and "
      "edges");
    v("columns", self.columns, "", "number of columns of a spinning LiDAR's range image",
      at_least(16));
    v("row_stride", self.row_stride, "", "every n-th row is used", at_least(1));
    v("min_range_m", self.min_range_m, "m", "nearer points are dropped", at_least(0));
    v("max_range_m", self.max_range_m, "m", "farther points are dropped", above(0));
    v("edge_threshold_m2", self.edge_threshold_m2, "m^2", "minimum roughness of an edge point",
      above(0));
    v("row_surface_voxel_size_m", self.row_surface_voxel_size_m, "m",
      "voxel size in which the surface points of each row are averaged", above(0));
    v("edge_voxel_size_m", self.edge_voxel_size_m, "m",
      "voxel size in which edge points are averaged, in scans and in the map", above(0));
    v("surface_voxel_size_m", self.surface_voxel_size_m, "m",
      "voxel size in which surface points are averaged, in scans and in the map", above(0));
    v("min_edges", self.min_edges, "", "a scan without more edge points is not registered",
      at_least(0));
    v("min_surfaces", self.min_surfaces, "", "a scan without more surface points is not registered",
      at_least(0));
    v("keyframe_translation_m", self.keyframe_translation_m, "m",
      "a scan becomes a keyframe after this translation since the last one", above(0));
    v("keyframe_rotation_rad", self.keyframe_rotation_rad, "rad",
      "a scan becomes a keyframe after this rotation about an axis since the last one", above(0));
    v("submap_radius_m", self.submap_radius_m, "m",
      "radius around the last keyframe within which keyframes enter the submap", above(0));
    v("submap_keyframe_spacing_m", self.submap_keyframe_spacing_m, "m",
      "edge of the cells from each of which a keyframe enters the submap", above(0));
    v("gravity", self.gravity, "m/s^2", "magnitude of gravity", above(0));
    v("gyro_noise_density", self.gyro_noise_density, "rad/s/sqrt(Hz)", "noise density of the gyro",
      above(0));
    v("accel_noise_density", self.accel_noise_density, "m/s^2/sqrt(Hz)",
      "noise density of the accelerometer", above(0));
    v("gyro_bias_walk", self.gyro_bias_walk, "rad/s^2/sqrt(Hz)", "random walk of the gyro's bias",
      at_least(0));
    v("accel_bias_walk", self.accel_bias_walk, "m/s^3/sqrt(Hz)",
      "random walk of the accelerometer's bias", at_least(0));
    v("loop_closure", self.loop_closure, "", "whether loops are searched for");
    v("loop", self.loop, "", "how loops are searched for and accepted");
  }
};

/// The values shipped with the program, or for Livox sensors (and those of unknown kind) with its
/// port. Only `columns` is the LiDAR's.
Config published(const LidarInfo& lidar);
/// The program's own advice for rooms: smaller voxels, and points from 0.5 m on.
Config indoor(const LidarInfo& lidar);
/// The best of 32 settings of the program on flights of the development set (docs/results/tuning),
/// for half sweeps.
Config tuned(const LidarInfo& lidar);

constexpr auto enum_names(Sensor) {
  return std::array{std::pair{"spinning", Sensor::kSpinning}, std::pair{"livox", Sensor::kLivox}};
}

}  // namespace lidarena::odometry::lio_sam
