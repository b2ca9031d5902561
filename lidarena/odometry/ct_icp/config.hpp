// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "lidarena/base/config.hpp"
#include "lidarena/base/rig.hpp"
#include "lidarena/estimation/elastic_alignment.hpp"
#include "lidarena/map/voxel_key.hpp"

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
  kConstantTwist,   ///< from the last scan's end with its mean velocity, by real time
};

enum class Solver {
  kGaussNewton,  ///< point to plane, our own normal equations
  kCeres,        ///< point to plane, Levenberg-Marquardt
  kCeresShapes,  ///< point to line, plane or distribution, by shape; Levenberg-Marquardt
};

/// Point of a neighborhood that lies in its plane.
enum class PlanePoint { kFarthest, kNearest, kMean };

/// Which scans are inserted into the map (after too many skipped in a row, one is in any case).
enum class Insertion {
  kAlways,
  kSmallRotation,  ///< scans that rotate by at most max_rotation_rad from begin to end
  kTrusted,        ///< scans of which the registration is trusted, see RobustConfig
};

struct SamplingConfig {
  double min_range_m = 0.0;
  double max_range_m = 1000.0;
  double scan_voxel_size_m = 0.3;
  double keypoint_voxel_size_m = 0.6;
  KeypointSampling keypoints = KeypointSampling::kAdaptive;
  int max_keypoints = 800;
  int initial_scans = 20;
  double initial_scan_voxel_size_m = 0.2;
  double initial_keypoint_voxel_size_m = 1.0;
  int rigid_scans = 2;

  /// Former names, for the message that names the new one.
  static constexpr RenamedKey renamed_keys[] = {
      {"frame_voxel_m", "scan_voxel_size_m"},
      {"keypoint_voxel_m", "keypoint_voxel_size_m"},
      {"start_scans", "initial_scans"},
      {"start_frame_voxel_m", "initial_scan_voxel_size_m"},
      {"start_keypoint_voxel_m", "initial_keypoint_voxel_size_m"}};

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("min_range_m", self.min_range_m, "m", "nearer points are dropped", at_least(0));
    v("max_range_m", self.max_range_m, "m", "farther points are dropped", above(0));
    v("scan_voxel_size_m", self.scan_voxel_size_m, "m",
      "voxel size of the downsampled scan, of which one point per cell goes into the map",
      above(0));
    v("keypoint_voxel_size_m", self.keypoint_voxel_size_m, "m",
      "voxel size of the keypoints, with keypoints: grid", above(0));
    v("keypoints", self.keypoints, "", "which points are registered: all, grid or adaptive");
    v("max_keypoints", self.max_keypoints, "",
      "upper limit on the keypoints, drawn at random; 0: no limit", at_least(0));
    v("initial_scans", self.initial_scans, "",
      "number of scans at the start that use the next two voxel sizes and no max_keypoints",
      at_least(0));
    v("initial_scan_voxel_size_m", self.initial_scan_voxel_size_m, "m",
      "scan_voxel_size_m during initial_scans", above(0));
    v("initial_keypoint_voxel_size_m", self.initial_keypoint_voxel_size_m, "m",
      "keypoint_voxel_size_m during initial_scans", above(0));
    v("rigid_scans", self.rigid_scans, "",
      "number of scans at the start registered without motion within the scan", at_least(1));
  }
};

struct RegistrationConfig {
  Solver solver = Solver::kCeres;
  InitialMotion initial_motion = InitialMotion::kLastPose;
  int segments = 1;
  int max_iterations = 8;
  int initial_iterations = 15;
  int inner_iterations = 20;
  double convergence_translation_m = 0.01;
  double convergence_rotation_rad = 0.1 * 3.14159265358979 / 180.0;
  double search_radius_m = 0.75;
  double reassociation_distance_m = 0.0;
  int min_neighbors = 20;
  int max_neighbors = 20;
  PlanePoint plane_point = PlanePoint::kFarthest;
  double planarity_weight = 0.9;
  double proximity_weight = 0.1;
  bool gate_distances = false;
  double max_plane_distance_m = 0.3;
  estimation::RobustKernel robust_kernel = estimation::RobustKernel::kCauchy;
  double robust_kernel_scale_m = 0.1;
  int max_residuals = 0;
  int min_residuals = 20;
  bool exact_slerp = true;

  /// Former names, for the message that names the new one.
  static constexpr RenamedKey renamed_keys[] = {
      {"start_iterations", "initial_iterations"},
      {"translation_threshold_m", "convergence_translation_m"},
      {"rotation_threshold_rad", "convergence_rotation_rad"},
      {"search_again_m", "reassociation_distance_m"},
      {"min_neighbours", "min_neighbors"},
      {"max_neighbours", "max_neighbors"},
      {"nearness_weight", "proximity_weight"},
      {"loss", "robust_kernel"},
      {"loss_scale_m", "robust_kernel_scale_m"}};

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("solver", self.solver, "", "gauss_newton, ceres or ceres_shapes");
    v("initial_motion", self.initial_motion, "",
      "initial guess: last_pose, constant_motion or constant_twist");
    v("segments", self.segments, "",
      "number of pieces of constant velocity within a scan; 1 in the paper", Limits{1, 16});
    v("max_iterations", self.max_iterations, "",
      "maximum number of neighbor searches, each followed by a solution", at_least(1));
    v("initial_iterations", self.initial_iterations, "",
      "lower limit on max_iterations during initial_scans", at_least(0));
    v("inner_iterations", self.inner_iterations, "",
      "iterations of the solver between two searches", at_least(1));
    v("convergence_translation_m", self.convergence_translation_m, "m",
      "registration ends when an iteration translates both ends together by less ...", at_least(0));
    v("convergence_rotation_rad", self.convergence_rotation_rad, "rad",
      "... and rotates them by less", at_least(0));
    v("search_radius_m", self.search_radius_m, "m", "radius of the neighbor search in the map",
      above(0));
    v("reassociation_distance_m", self.reassociation_distance_m, "m",
      "neighbors are searched again after a keypoint has moved this far; 0: in each iteration",
      at_least(0));
    v("min_neighbors", self.min_neighbors, "", "a keypoint with fewer neighbors is not matched",
      at_least(3));
    v("max_neighbors", self.max_neighbors, "", "number of nearest neighbors used", Limits{3, 64});
    v("plane_point", self.plane_point, "",
      "point that lies in the plane: farthest (the published program), nearest or mean of the "
      "neighbors");
    v("planarity_weight", self.planarity_weight, "",
      "share of the squared planarity in a match's weight", at_least(0));
    v("proximity_weight", self.proximity_weight, "",
      "share of the exponential of the plane point's distance in a match's weight", at_least(0));
    v("gate_distances", self.gate_distances, "", "drop matches beyond max_plane_distance_m");
    v("max_plane_distance_m", self.max_plane_distance_m, "m",
      "see gate_distances; times min_neighbors it is the decay length of proximity_weight's "
      "exponential",
      above(0));
    v("robust_kernel", self.robust_kernel, "",
      "robust kernel of the residuals: none, huber, cauchy or tukey");
    v("robust_kernel_scale_m", self.robust_kernel_scale_m, "m",
      "scale of the robust kernel, on the weighted distance", above(0));
    v("max_residuals", self.max_residuals, "", "maximum number of matches used, in order; 0: all",
      at_least(0));
    v("min_residuals", self.min_residuals, "",
      "with fewer matches the registration of the scan fails", at_least(1));
    v("exact_slerp", self.exact_slerp, "",
      "Gauss-Newton: exact derivative of the slerp; false: first order, as in the published "
      "program");
  }
};

struct PriorConfig {
  double location = 0.001;
  double velocity = 0.001;
  double orientation = 0.0;
  double angular_velocity = 0.0;
  double small_velocity = 0.0;
  double velocity_change = 0.0;
  double angular_velocity_change = 0.0;

  /// Former names, for the message that names the new one.
  static constexpr RenamedKey renamed_keys[] = {{"bend", "velocity_change"},
                                                {"angular_bend", "angular_velocity_change"}};

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("location", self.location, "", "weight of: the scan begins where the last one ended",
      at_least(0));
    v("velocity", self.velocity, "", "weight of: it has the velocity of the last one", at_least(0));
    v("orientation", self.orientation, "m^2/rad^2",
      "weight of: it begins with the rotation at which the last one ended", at_least(0));
    v("angular_velocity", self.angular_velocity, "m^2/rad^2",
      "weight of: it has the angular velocity of the last one", at_least(0));
    v("small_velocity", self.small_velocity, "", "weight of: it ends where it began", at_least(0));
    v("velocity_change", self.velocity_change, "",
      "weight of: neighboring segments have the same velocity", at_least(0));
    v("angular_velocity_change", self.angular_velocity_change, "m^2/rad^2",
      "weight of: neighboring segments have the same angular velocity", at_least(0));
  }
};

struct MapConfig {
  double voxel_size_m = 0.8;
  int max_points_per_voxel = 30;
  double min_point_spacing_m = 0.08;
  double radius_m = 100.0;

  /// Former names, for the message that names the new one.
  static constexpr RenamedKey renamed_keys[] = {{"voxel_m", "voxel_size_m"},
                                                {"max_points", "max_points_per_voxel"},
                                                {"spacing_m", "min_point_spacing_m"}};

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

struct InsertionConfig {
  Insertion rule = Insertion::kSmallRotation;
  double max_rotation_rad = 3.0 * 3.14159265358979 / 180.0;
  int max_skipped = 5;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("rule", self.rule, "", "which scans enter the map: always, small_rotation or trusted");
    v("max_rotation_rad", self.max_rotation_rad, "rad",
      "with small_rotation: maximum rotation from begin to end of a scan", above(0));
    v("max_skipped", self.max_skipped, "",
      "after more skipped scans in a row than this, the next one is inserted in any case",
      at_least(0));
  }
};

/// When a registration is trusted, and what happens otherwise.
struct RobustConfig {
  bool enabled = false;
  int max_attempts = 6;
  double max_rotation_rad = 3.0 * 3.14159265358979 / 180.0;
  double min_matched_share = 0.0;
  double lost_translation_m = 5.0;
  double lost_rotation_rad = 30.0 * 3.14159265358979 / 180.0;
  bool stop_when_lost = true;
  double lost_motion_factor = 1.0;

  /// Former names, for the message that names the new one.
  static constexpr RenamedKey renamed_keys[] = {{"max_translation_m", "lost_translation_m"},
                                                {"max_turn_rad", "lost_rotation_rad"},
                                                {"motion_kept_when_lost", "lost_motion_factor"}};

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("enabled", self.enabled, "",
      "repeat a registration that is not trusted, with more keypoints and iterations, from the "
      "same guess");
    v("max_attempts", self.max_attempts, "", "maximum number of registrations of a scan",
      at_least(1));
    v("max_rotation_rad", self.max_rotation_rad, "rad",
      "a registration with a larger rotation is not trusted", above(0));
    v("min_matched_share", self.min_matched_share, "",
      "a registration with a smaller share of matched keypoints is not trusted", between(0, 1));
    v("lost_translation_m", self.lost_translation_m, "m",
      "a registration with a larger translation has failed", above(0));
    v("lost_rotation_rad", self.lost_rotation_rad, "rad",
      "a registration with a larger rotation has failed", above(0));
    v("stop_when_lost", self.stop_when_lost, "",
      "report divergence after a failed registration, where the published program ends; false: use "
      "the prediction");
    v("lost_motion_factor", self.lost_motion_factor, "",
      "factor on the predicted motion after each failed registration; with constant_twist",
      between(0, 1));
  }
};

/// The defaults are the published program's handheld profile (2022); preset() changes them.
struct Config {
  map::VoxelRounding voxel_rounding = map::VoxelRounding::kTruncate;
  SamplingConfig sampling;
  RegistrationConfig registration;
  PriorConfig prior;
  MapConfig map;
  InsertionConfig insertion;
  RobustConfig robust;

  /// Former names, for the message that names the new one.
  static constexpr RenamedKey renamed_keys[] = {{"cell_rounding", "voxel_rounding"}};

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("voxel_rounding", self.voxel_rounding, "",
      "how a point's cell is computed in the scan's grids and the map: floor, or truncate: the "
      "cells around x, y, z = 0 are twice as wide");
    v("sampling", self.sampling, "", "which points are used");
    v("registration", self.registration, "", "how they are aligned with the map");
    v("prior", self.prior, "",
      "motion prior: weights relative to the mean squared error of a point");
    v("map", self.map, "", "the local map");
    v("insertion", self.insertion, "", "which scans enter it");
    v("robust", self.robust, "", "how untrusted and failed registrations are handled");
  }
};

/// The program's own defaults.
Config published(const LidarInfo& lidar);
/// What a user of the program would set for a small sensor in rooms and tunnels.
Config indoor(const LidarInfo& lidar);

constexpr auto enum_names(KeypointSampling) {
  return std::array{std::pair{"all", KeypointSampling::kAll},
                    std::pair{"grid", KeypointSampling::kGrid},
                    std::pair{"adaptive", KeypointSampling::kAdaptive}};
}

constexpr auto enum_names(InitialMotion) {
  return std::array{std::pair{"last_pose", InitialMotion::kLastPose},
                    std::pair{"constant_motion", InitialMotion::kConstantMotion},
                    std::pair{"constant_twist", InitialMotion::kConstantTwist}};
}

constexpr auto enum_names(Solver) {
  return std::array{std::pair{"gauss_newton", Solver::kGaussNewton},
                    std::pair{"ceres", Solver::kCeres},
                    std::pair{"ceres_shapes", Solver::kCeresShapes}};
}

constexpr auto enum_names(PlanePoint) {
  return std::array{std::pair{"farthest", PlanePoint::kFarthest},
                    std::pair{"nearest", PlanePoint::kNearest},
                    std::pair{"mean", PlanePoint::kMean}};
}

constexpr auto enum_names(Insertion) {
  return std::array{std::pair{"always", Insertion::kAlways},
                    std::pair{"small_rotation", Insertion::kSmallRotation},
                    std::pair{"trusted", Insertion::kTrusted}};
}

}  // namespace lidarena::odometry::ct_icp
