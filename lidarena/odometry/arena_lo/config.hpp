// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/base/config.hpp"
#include "lidarena/base/rig.hpp"

namespace lidarena::odometry::arena_lo {

struct SamplingConfig {
  double min_range_m = 0.1;
  double max_range_m = 100.0;
  double scan_voxel_size_m = 0.1;
  double keypoint_voxel_size_m = 0.25;
  int max_keypoints = 2500;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("min_range_m", self.min_range_m, "m", "nearer points are dropped", at_least(0));
    v("max_range_m", self.max_range_m, "m", "farther points are dropped", above(0));
    v("scan_voxel_size_m", self.scan_voxel_size_m, "m",
      "voxel size of the downsampled scan, of which one point per cell goes into the map",
      above(0));
    v("keypoint_voxel_size_m", self.keypoint_voxel_size_m, "m",
      "voxel size of the keypoints, the points of the downsampled scan that are registered",
      above(0));
    v("max_keypoints", self.max_keypoints, "",
      "upper limit on the keypoints, drawn at random; accuracy against time", at_least(1));
  }
};

struct RegistrationConfig {
  int segments = 3;
  int max_iterations = 30;
  double search_radius_m = 0.4;
  double reassociation_distance_m = 0.03;
  int min_neighbors = 10;
  double robust_kernel_scale_m = 0.05;
  double lost_rotation_rad = 1.2;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("segments", self.segments, "", "number of pieces of constant velocity within a scan",
      Limits{1, 16});
    v("max_iterations", self.max_iterations, "", "maximum number of Gauss-Newton steps",
      at_least(1));
    v("search_radius_m", self.search_radius_m, "m", "radius of the neighbor search in the map",
      above(0));
    v("reassociation_distance_m", self.reassociation_distance_m, "m",
      "neighbors are searched again after a keypoint has moved this far; larger is faster; 0: in "
      "each iteration",
      at_least(0));
    v("min_neighbors", self.min_neighbors, "", "a keypoint with fewer neighbors is not matched",
      at_least(3));
    v("robust_kernel_scale_m", self.robust_kernel_scale_m, "m",
      "scale of the Cauchy kernel, on the weighted distance", above(0));
    v("lost_rotation_rad", self.lost_rotation_rad, "rad",
      "a registration with a larger rotation within the scan has failed; default: 690 deg/s at 10 "
      "Hz, twice that of an aggressive flight",
      above(0));
  }
};

struct PriorConfig {
  double location = 0.01;
  double orientation = 0.01;
  double velocity = 0.001;
  double velocity_change = 0.01;
  double angular_velocity_change = 0.02;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("location", self.location, "", "weight of: the scan begins at the predicted position",
      at_least(0));
    v("orientation", self.orientation, "m^2/rad^2",
      "weight of: it begins with the predicted rotation", at_least(0));
    v("velocity", self.velocity, "", "weight of: it has the predicted velocity", at_least(0));
    v("velocity_change", self.velocity_change, "",
      "weight of: neighboring segments have the same velocity", at_least(0));
    v("angular_velocity_change", self.angular_velocity_change, "m^2/rad^2",
      "weight of: neighboring segments have the same angular velocity", at_least(0));
  }
};

struct MapConfig {
  double voxel_size_m = 0.4;
  int max_points_per_voxel = 40;
  double min_point_spacing_m = 0.05;
  double radius_m = 150.0;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("voxel_size_m", self.voxel_size_m, "m",
      "voxel size; with a larger search radius a search visits 125 cells instead of 27", above(0));
    v("max_points_per_voxel", self.max_points_per_voxel, "", "maximum number of points in a cell",
      Limits{1, 4096});
    v("min_point_spacing_m", self.min_point_spacing_m, "m",
      "minimum distance between the points of a cell", at_least(0));
    v("radius_m", self.radius_m, "m", "points farther from the sensor are removed", above(0));
  }
};

struct Config {
  SamplingConfig sampling;
  RegistrationConfig registration;
  PriorConfig prior;
  MapConfig map;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("sampling", self.sampling, "", "which points are used");
    v("registration", self.registration, "", "how they are aligned with the map");
    v("prior", self.prior, "",
      "motion prior: weights relative to the mean squared error of a point");
    v("map", self.map, "", "the local map");
  }
};

/// The settings for `lidar`: its range limits, and a map of 1.5 times its maximum range.
Config settings_for(const LidarInfo& lidar);

}  // namespace lidarena::odometry::arena_lo
