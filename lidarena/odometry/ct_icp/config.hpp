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

namespace lidarena::ct_icp {

/// Which points of a thinned scan are registered.
enum class KeypointSampling {
  kAll,
  kGrid,      ///< one a cell
  kAdaptive,  ///< one a cell whose edge grows with the range, from 0.1 to 1.6 m
};

/// Where registration starts.
enum class InitialMotion {
  kLastPose,        ///< begin and end of the scan where the last one ended
  kConstantMotion,  ///< begin and end each go on by as much as the last time, whatever it took
  kConstantTwist,   ///< from the last scan's end with its mean velocity, by real time
};

enum class Solver {
  kGaussNewton,  ///< point to plane, our own normal equations
  kCeres,        ///< point to plane, Levenberg-Marquardt
  kCeresShapes,  ///< likewise with lines, planes and distributions, whatever a neighborhood is
};

/// The point of a neighborhood that its plane is laid through.
enum class PlanePoint { kFarthest, kNearest, kMean };

/// When a scan is not inserted into the map (until too many in a row were not).
enum class Insertion {
  kAlways,
  kSmallRotation,  ///< not when it turned by more than max_rotation_rad from begin to end
  kTrusted,        ///< not when its registration is not trusted, see RobustConfig
};

struct SamplingConfig {
  double min_range_m = 0.0;
  double max_range_m = 1000.0;
  double frame_voxel_m = 0.3;
  double keypoint_voxel_m = 0.6;
  KeypointSampling keypoints = KeypointSampling::kAdaptive;
  int max_keypoints = 800;
  int start_scans = 20;
  double start_frame_voxel_m = 0.2;
  double start_keypoint_voxel_m = 1.0;
  int rigid_scans = 2;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("min_range_m", self.min_range_m, "m", "nearer points are dropped", at_least(0));
    v("max_range_m", self.max_range_m, "m", "farther points are dropped", above(0));
    v("frame_voxel_m", self.frame_voxel_m, "m",
      "one point of each such cell is kept, and goes into the map", above(0));
    v("keypoint_voxel_m", self.keypoint_voxel_m, "m", "grid: edge of a keypoint's cell", above(0));
    v("keypoints", self.keypoints, "", "all, grid or adaptive");
    v("max_keypoints", self.max_keypoints, "", "of these at most, at random; 0: no limit",
      at_least(0));
    v("start_scans", self.start_scans, "", "so many scans are sampled as the next two say",
      at_least(0));
    v("start_frame_voxel_m", self.start_frame_voxel_m, "m", "", above(0));
    v("start_keypoint_voxel_m", self.start_keypoint_voxel_m, "m", "", above(0));
    v("rigid_scans", self.rigid_scans, "", "the first scans are taken for instantaneous",
      at_least(1));
  }
};

struct RegistrationConfig {
  Solver solver = Solver::kCeres;
  InitialMotion initial_motion = InitialMotion::kLastPose;
  int segments = 1;
  int max_iterations = 8;
  int start_iterations = 15;
  int inner_iterations = 20;
  double translation_threshold_m = 0.01;
  double rotation_threshold_rad = 0.1 * 3.14159265358979 / 180.0;
  double search_radius_m = 0.75;
  double search_again_m = 0.0;
  int min_neighbors = 20;
  int max_neighbors = 20;
  PlanePoint plane_point = PlanePoint::kFarthest;
  double planarity_weight = 0.9;
  double nearness_weight = 0.1;
  bool gate_distances = false;
  double max_plane_distance_m = 0.3;
  RobustKernel robust_kernel = RobustKernel::kCauchy;
  double robust_kernel_scale_m = 0.1;
  int max_residuals = 0;
  int min_residuals = 20;
  bool exact_slerp = true;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("solver", self.solver, "", "gauss_newton, ceres or ceres_shapes");
    v("initial_motion", self.initial_motion, "", "last_pose, constant_motion or constant_twist");
    v("segments", self.segments, "", "pieces of constant velocity within a scan; the paper has one",
      Limits{1, 16});
    v("max_iterations", self.max_iterations, "", "searches and solutions in turn", at_least(1));
    v("start_iterations", self.start_iterations, "", "at least, for the first start_scans",
      at_least(0));
    v("inner_iterations", self.inner_iterations, "", "of the solver between two searches",
      at_least(1));
    v("translation_threshold_m", self.translation_threshold_m, "m",
      "registration ends when both ends together moved less ...", at_least(0));
    v("rotation_threshold_rad", self.rotation_threshold_rad, "rad", "... and turned less",
      at_least(0));
    v("search_radius_m", self.search_radius_m, "m", "for neighbors in the map", above(0));
    v("search_again_m", self.search_again_m, "m",
      "neighbors are searched anew once a keypoint moved so far; 0: in each iteration",
      at_least(0));
    v("min_neighbors", self.min_neighbors, "", "a keypoint with fewer is not matched", at_least(3));
    v("max_neighbors", self.max_neighbors, "", "the nearest so many count", Limits{3, 64});
    v("plane_point", self.plane_point, "",
      "what a plane is laid through: farthest (the public program), nearest or mean of neighbors");
    v("planarity_weight", self.planarity_weight, "", "of the square of a neighborhood's planarity",
      at_least(0));
    v("nearness_weight", self.nearness_weight, "",
      "of the exponential of the plane point's distance", at_least(0));
    v("gate_distances", self.gate_distances, "", "matches beyond max_plane_distance_m are dropped");
    v("max_plane_distance_m", self.max_plane_distance_m, "m", "", above(0));
    v("robust_kernel", self.robust_kernel, "", "none, huber, cauchy or tukey");
    v("robust_kernel_scale_m", self.robust_kernel_scale_m, "m", "of the weighted distance",
      above(0));
    v("max_residuals", self.max_residuals, "", "the first so many count; 0: all", at_least(0));
    v("min_residuals", self.min_residuals, "", "with fewer the scan is lost", at_least(1));
    v("exact_slerp", self.exact_slerp, "",
      "Gauss-Newton: derivative of the slerp itself; false: the public program's first order");
  }
};

struct PriorConfig {
  double location = 0.001;
  double velocity = 0.001;
  double orientation = 0.0;
  double angular_velocity = 0.0;
  double small_velocity = 0.0;
  double bend = 0.0;
  double angular_bend = 0.0;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("location", self.location, "", "the scan begins where the last one ended", at_least(0));
    v("velocity", self.velocity, "", "it goes on as fast", at_least(0));
    v("orientation", self.orientation, "m^2/rad^2", "it begins turned as the last one ended",
      at_least(0));
    v("angular_velocity", self.angular_velocity, "m^2/rad^2", "it turns on as fast", at_least(0));
    v("small_velocity", self.small_velocity, "", "it ends where it began", at_least(0));
    v("bend", self.bend, "", "its segments are alike in velocity ...", at_least(0));
    v("angular_bend", self.angular_bend, "m^2/rad^2", "... and in angular velocity", at_least(0));
  }
};

struct MapConfig {
  double voxel_m = 0.8;
  int max_points = 30;
  double spacing_m = 0.08;
  double radius_m = 100.0;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("voxel_m", self.voxel_m, "m",
      "edge of a cell; a search radius beyond it makes a search visit 125 cells instead of 27",
      above(0));
    v("max_points", self.max_points, "", "of a cell", Limits{1, 4096});
    v("spacing_m", self.spacing_m, "m", "between the points of a cell", at_least(0));
    v("radius_m", self.radius_m, "m", "the map is forgotten beyond this", above(0));
  }
};

struct InsertionConfig {
  Insertion rule = Insertion::kSmallRotation;
  double max_rotation_rad = 3.0 * 3.14159265358979 / 180.0;
  int max_skipped = 5;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("rule", self.rule, "", "always, small_rotation or trusted");
    v("max_rotation_rad", self.max_rotation_rad, "rad", "small_rotation: from begin to end",
      above(0));
    v("max_skipped", self.max_skipped, "", "after more scans in a row than this one is inserted",
      at_least(0));
  }
};

/// When a registration is trusted, and what is done when it is not.
struct RobustConfig {
  bool enabled = false;
  int max_attempts = 6;
  double max_rotation_rad = 3.0 * 3.14159265358979 / 180.0;
  double min_matched_share = 0.0;
  double max_translation_m = 5.0;
  double max_turn_rad = 30.0 * 3.14159265358979 / 180.0;
  bool stop_when_lost = true;
  double motion_kept_when_lost = 1.0;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("enabled", self.enabled, "",
      "a registration that is not trusted is tried again, finer and longer, from the same guess");
    v("max_attempts", self.max_attempts, "", "", at_least(1));
    v("max_rotation_rad", self.max_rotation_rad, "rad", "a scan that turns more is not trusted",
      above(0));
    v("min_matched_share", self.min_matched_share, "",
      "a scan fewer of whose keypoints are matched is not trusted", between(0, 1));
    v("max_translation_m", self.max_translation_m, "m", "a scan that moves farther is lost",
      above(0));
    v("max_turn_rad", self.max_turn_rad, "rad", "a scan that turns more is lost", above(0));
    v("stop_when_lost", self.stop_when_lost, "",
      "the run ends there, as the public program; false: the prediction stands in");
    v("motion_kept_when_lost", self.motion_kept_when_lost, "",
      "factor on the predicted motion after each lost scan; constant_twist", between(0, 1));
  }
};

/// The defaults are the public program's handheld profile (2022); preset() changes them.
struct Config {
  VoxelRounding cell_rounding = VoxelRounding::kTruncate;
  SamplingConfig sampling;
  RegistrationConfig registration;
  PriorConfig prior;
  MapConfig map;
  InsertionConfig insertion;
  RobustConfig robust;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("cell_rounding", self.cell_rounding, "",
      "floor, or truncate: in the scan's grids and the map, cells about zero are twice as wide");
    v("sampling", self.sampling, "", "which points are used");
    v("registration", self.registration, "", "how they are aligned with the map");
    v("prior", self.prior, "", "what is expected of the motion, against a point's squared error");
    v("map", self.map, "", "the local map");
    v("insertion", self.insertion, "", "which scans enter it");
    v("robust", self.robust, "", "bad registrations");
  }
};

/// Names of preset(), the default first.
std::vector<std::string> preset_names();

/// Settings for a LiDAR: "improved"; "original", the public program of 2022 with its handheld
/// profile. Throws InputError for another name.
Config preset(const std::string& name, const LidarInfo& lidar);

}  // namespace lidarena::ct_icp

namespace lidarena {

template <>
struct EnumNames<ct_icp::KeypointSampling> {
  static constexpr std::array names{std::pair{"all", ct_icp::KeypointSampling::kAll},
                                    std::pair{"grid", ct_icp::KeypointSampling::kGrid},
                                    std::pair{"adaptive", ct_icp::KeypointSampling::kAdaptive}};
};

template <>
struct EnumNames<ct_icp::InitialMotion> {
  static constexpr std::array names{
      std::pair{"last_pose", ct_icp::InitialMotion::kLastPose},
      std::pair{"constant_motion", ct_icp::InitialMotion::kConstantMotion},
      std::pair{"constant_twist", ct_icp::InitialMotion::kConstantTwist}};
};

template <>
struct EnumNames<ct_icp::Solver> {
  static constexpr std::array names{std::pair{"gauss_newton", ct_icp::Solver::kGaussNewton},
                                    std::pair{"ceres", ct_icp::Solver::kCeres},
                                    std::pair{"ceres_shapes", ct_icp::Solver::kCeresShapes}};
};

template <>
struct EnumNames<ct_icp::PlanePoint> {
  static constexpr std::array names{std::pair{"farthest", ct_icp::PlanePoint::kFarthest},
                                    std::pair{"nearest", ct_icp::PlanePoint::kNearest},
                                    std::pair{"mean", ct_icp::PlanePoint::kMean}};
};

template <>
struct EnumNames<ct_icp::Insertion> {
  static constexpr std::array names{std::pair{"always", ct_icp::Insertion::kAlways},
                                    std::pair{"small_rotation", ct_icp::Insertion::kSmallRotation},
                                    std::pair{"trusted", ct_icp::Insertion::kTrusted}};
};

}  // namespace lidarena
