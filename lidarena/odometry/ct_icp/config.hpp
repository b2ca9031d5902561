// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <utility>

#include "lidarena/base/config.hpp"
#include "lidarena/base/rig.hpp"

namespace lidarena::odometry::ct_icp {

/// Which points of a downsampled scan are registered.
enum class KeypointSampling {
  kAll,
  kGrid,      ///< one per cell
  kAdaptive,  ///< one per cell, the edge of which grows with the range from 0.1 to 1.6 m
};

/// Initial guess of the registration.
enum class InitialMotion {
  kLastPose,        ///< the scan begins and ends where the last one ended
  kConstantMotion,  ///< begin and end each repeat their last motion, regardless of the time between
};

struct SamplingConfig {
  double scan_voxel_size_m = 0.3;
  KeypointSampling keypoints = KeypointSampling::kAdaptive;
  double keypoint_voxel_size_m = 0.6;
  int max_keypoints = 800;
  int initial_scans = 20;
  double initial_scan_voxel_size_m = 0.2;
  double initial_keypoint_voxel_size_m = 1.0;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("scan_voxel_size_m", self.scan_voxel_size_m, "m",
      "voxel size of the downsampled scan, of which one point per cell goes into the map",
      above(0));
    v("keypoints", self.keypoints, "", "which points are registered: all, grid or adaptive");
    v("keypoint_voxel_size_m", self.keypoint_voxel_size_m, "m",
      "voxel size of the keypoints, with keypoints: grid", above(0));
    v("max_keypoints", self.max_keypoints, "",
      "upper limit on the keypoints, drawn at random; 0: no limit", at_least(0));
    v("initial_scans", self.initial_scans, "",
      "number of scans at the start that use the next two voxel sizes, no max_keypoints and at "
      "least 15 iterations",
      at_least(0));
    v("initial_scan_voxel_size_m", self.initial_scan_voxel_size_m, "m",
      "scan_voxel_size_m during initial_scans", above(0));
    v("initial_keypoint_voxel_size_m", self.initial_keypoint_voxel_size_m, "m",
      "keypoint_voxel_size_m during initial_scans", above(0));
  }
};

struct RegistrationConfig {
  InitialMotion initial_motion = InitialMotion::kLastPose;
  int max_iterations = 8;
  int inner_iterations = 20;
  double convergence_translation_m = 0.01;
  double convergence_rotation_rad = 0.1 * 3.14159265358979 / 180.0;
  double search_radius_m = 0.75;
  int min_neighbors = 20;
  int max_neighbors = 20;
  double planarity_weight = 0.9;
  double proximity_weight = 0.1;
  double max_plane_distance_m = 0.3;
  double robust_kernel_scale_m = 0.1;
  double max_translation_m = 5.0;
  double max_rotation_deg = 30.0;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("initial_motion", self.initial_motion, "", "initial guess: last_pose or constant_motion");
    v("max_iterations", self.max_iterations, "",
      "maximum number of neighbor searches, each followed by a solution", at_least(1));
    v("inner_iterations", self.inner_iterations, "",
      "maximum number of steps of the solver between two searches", at_least(1));
    v("convergence_translation_m", self.convergence_translation_m, "m",
      "registration ends when an iteration translates both ends together by less ...", at_least(0));
    v("convergence_rotation_rad", self.convergence_rotation_rad, "rad",
      "... and rotates them by less", at_least(0));
    v("search_radius_m", self.search_radius_m, "m", "radius of the neighbor search in the map",
      above(0));
    v("min_neighbors", self.min_neighbors, "",
      "a keypoint with fewer neighbors is not matched; with fewer matches than this a scan's "
      "registration fails",
      at_least(3));
    v("max_neighbors", self.max_neighbors, "", "number of nearest neighbors used", Limits{3, 64});
    v("planarity_weight", self.planarity_weight, "",
      "share of the squared planarity in a match's weight", at_least(0));
    v("proximity_weight", self.proximity_weight, "",
      "share of the exponential of the plane point's distance in a match's weight", at_least(0));
    v("max_plane_distance_m", self.max_plane_distance_m, "m",
      "times min_neighbors it is the decay length of proximity_weight's exponential", above(0));
    v("robust_kernel_scale_m", self.robust_kernel_scale_m, "m",
      "scale of the Cauchy kernel, on the weighted distance", above(0));
    v("max_translation_m", self.max_translation_m, "m",
      "a scan that moves farther is an error, at which the method ends", above(0));
    v("max_rotation_deg", self.max_rotation_deg, "deg",
      "so is one that rotates by more, within it or since the end of the last one",
      Limits{0.0, 180.0});
  }
};

/// The published program's robust registration: a scan whose registration is not trusted is
/// registered again, from the initial guess, with more careful settings.
struct RobustConfig {
  bool enabled = false;
  int attempts = 6;
  double max_scan_rotation_deg = 3.0;
  double max_rotation_deg = 3.0;
  int minimal_level = 0;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("enabled", self.enabled, "",
      "register a scan again, with more careful settings, where it turns by more than the next two "
      "limits, moves by more than 1 m or fails; keep scans that turn out of the map");
    v("attempts", self.attempts, "", "number of registrations of a scan; the last one is accepted",
      at_least(1));
    v("max_scan_rotation_deg", self.max_scan_rotation_deg, "deg",
      "rotation within a scan up to which a registration is trusted", Limits{0.0, 180.0});
    v("max_rotation_deg", self.max_rotation_deg, "deg", "the same since the end of the last scan",
      Limits{0.0, 180.0});
    v("minimal_level", self.minimal_level, "",
      "number of times that the settings of a scan's first attempt are made more careful; after "
      "trouble it is one more",
      Limits{0, 10});
  }
};

struct PriorConfig {
  double location = 0.001;
  double velocity = 0.001;
  double orientation = 0.0;
  double small_velocity = 0.0;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("location", self.location, "", "weight of: the scan begins where the last one ended",
      at_least(0));
    v("velocity", self.velocity, "", "weight of: it has the velocity of the last one", at_least(0));
    v("orientation", self.orientation, "m^2",
      "weight of: it begins with the rotation at which the last one ended; its error is the "
      "squared sine of half the angle",
      at_least(0));
    v("small_velocity", self.small_velocity, "", "weight of: it ends where it began", at_least(0));
  }
};

struct MapConfig {
  double voxel_size_m = 0.8;
  int max_points_per_voxel = 30;
  double min_point_spacing_m = 0.08;
  double radius_m = 100.0;
  bool always_insert = false;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("voxel_size_m", self.voxel_size_m, "m",
      "voxel size; with a larger search radius a search visits 125 cells instead of 27", above(0));
    v("max_points_per_voxel", self.max_points_per_voxel, "", "maximum number of points in a cell",
      Limits{1, 4096});
    v("min_point_spacing_m", self.min_point_spacing_m, "m",
      "minimum distance between the points of a cell", at_least(0));
    v("radius_m", self.radius_m, "m", "points farther from the sensor are removed", above(0));
    v("always_insert", self.always_insert, "",
      "insert every scan; false: a scan that rotates by more than 3 deg is skipped, but at most "
      "six in a row (with robust.enabled: every scan that is not trusted for its rotation)");
  }
};

/// The defaults are the preset indoor.
struct Config {
  SamplingConfig sampling;
  RegistrationConfig registration;
  RobustConfig robust;
  PriorConfig prior;
  MapConfig map;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("sampling", self.sampling, "", "which points are used");
    v("registration", self.registration, "", "how they are aligned with the map");
    v("robust", self.robust, "", "registering again what is not trusted");
    v("prior", self.prior, "",
      "motion prior: weights relative to the mean squared error of a point");
    v("map", self.map, "", "the local map");
  }
};

/// The program's defaults, its profile for driving.
Config published(const LidarInfo& lidar);
/// The program's profile for a handheld sensor.
Config indoor(const LidarInfo& lidar);
/// The best of 32 settings of the program on flights of the development set (docs/results/tuning).
Config tuned(const LidarInfo& lidar);

constexpr auto enum_names(KeypointSampling) {
  return std::array{std::pair{"all", KeypointSampling::kAll},
                    std::pair{"grid", KeypointSampling::kGrid},
                    std::pair{"adaptive", KeypointSampling::kAdaptive}};
}

constexpr auto enum_names(InitialMotion) {
  return std::array{std::pair{"last_pose", InitialMotion::kLastPose},
                    std::pair{"constant_motion", InitialMotion::kConstantMotion}};
}

}  // namespace lidarena::odometry::ct_icp
