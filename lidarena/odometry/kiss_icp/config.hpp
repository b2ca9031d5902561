// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lidarena/base/config.hpp"
#include "lidarena/base/rig.hpp"
#include "lidarena/map/voxel_filter.hpp"

namespace lidarena::odometry::kiss_icp {

/// Instant of the scan at which its pose holds and to which its points are de-skewed.
enum class PoseInstant { kScanMiddle, kScanEnd };

/// How the initial sigma enters the adaptive threshold.
enum class ThresholdStart {
  kBlended,     ///< initial_threshold_m always counts as the first sample
  kUntilMoved,  ///< used alone up to 5 min_motion_m from the start, afterwards not at all
};

/// Lever arm of the adaptive threshold, by which rotation errors become displacements of points.
enum class ThresholdLever {
  kMaxRange,   ///< max_range_m
  kMeanRange,  ///< mean range of the scan's keypoints
};

/// The defaults are the published program's of 2025; preset() changes them.
struct Config {
  double max_range_m = 100.0;
  double min_range_m = 0.0;
  std::optional<double> voxel_size_m;  ///< unset: max_range_m / 100
  int max_points_per_voxel = 20;
  bool min_spacing = true;
  map::VoxelRounding voxel_rounding = map::VoxelRounding::kFloor;
  map::ThinningOrder thinning_order = map::ThinningOrder::kTeschnerPrime;

  int slices = 1;
  double slice_above_m = 0.0;
  bool deskew = true;
  double scan_motion_share = 0.0;
  bool redeskew_first_scan = false;
  PoseInstant pose_instant = PoseInstant::kScanEnd;

  double initial_threshold_m = 2.0;
  double min_motion_m = 0.1;
  ThresholdStart threshold_start = ThresholdStart::kBlended;
  std::optional<double> threshold_memory;
  ThresholdLever threshold_lever = ThresholdLever::kMaxRange;

  std::optional<double> plane_thinness;
  double degenerate_cell_weight = 1.0;
  double map_thinning = 0.5;
  double keypoint_thinning = 1.5;
  int initial_scans = 0;
  double kernel_fraction = 1.0;
  bool kernel_scale_in_meters = false;
  int max_iterations = 500;
  double convergence = 1e-4;

  bool ignore_equal_times = false;
  bool motion_per_second = false;
  double lost_motion_factor = 1.0;
  bool sensor_centered = false;

  double voxel_size() const { return voxel_size_m.value_or(max_range_m / 100.0); }

  /// Former names, for the message that names the new one.
  static constexpr RenamedKey renamed_keys[] = {{"cell_rounding", "voxel_rounding"},
                                                {"own_motion", "scan_motion_share"},
                                                {"rebuild_start", "redeskew_first_scan"},
                                                {"shapeless_weight", "degenerate_cell_weight"},
                                                {"calm_start", "initial_scans"},
                                                {"kernel_in_metres", "kernel_scale_in_meters"},
                                                {"equal_times_are_no_times", "ignore_equal_times"},
                                                {"motion_kept_when_lost", "lost_motion_factor"},
                                                {"sensor_centred", "sensor_centered"}};

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("max_range_m", self.max_range_m, "m",
      "farther points are dropped; also the local map's radius and, by default, the lever arm of "
      "the adaptive threshold",
      above(0));
    v("min_range_m", self.min_range_m, "m", "nearer points are dropped", at_least(0));
    v("voxel_size_m", self.voxel_size_m, "m",
      "voxel size of the map, null: max_range_m / 100; smaller is more accurate and slower",
      above(0));
    v("max_points_per_voxel", self.max_points_per_voxel, "",
      "maximum number of points in a map cell", Limits{1, 4096});
    v("min_spacing", self.min_spacing, "",
      "keep the points of a cell at least voxel_size / sqrt(max_points_per_voxel) apart; false: "
      "keep the first points of a cell");
    v("voxel_rounding", self.voxel_rounding, "",
      "how a point's cell is computed: floor, or truncate: the cells around x, y, z = 0 are twice "
      "as wide");
    v("thinning_order", self.thinning_order, "",
      "order of the points after the first downsampling, which decides the points that the second "
      "one keeps: mixed, teschner or teschner_prime");
    v("slices", self.slices, "",
      "number of parts of equal duration into which a scan is cut, each registered on its own; "
      "above 1: not in the published program",
      Limits{1, 100});
    v("slice_above_m", self.slice_above_m, "m",
      "scans are cut only while sigma is above this: a part of a scan constrains the pose less "
      "than the whole scan, and helps only where the motion changes fast",
      at_least(0));
    v("deskew", self.deskew, "", "remove the motion within the scan, if its points carry times");
    v("scan_motion_share", self.scan_motion_share, "",
      "share of the scan's own motion, estimated anew in each ICP iteration, in the motion used "
      "for de-skewing; the rest is the previous motion. Near 1 the estimate oscillates; above 0: "
      "not in the published program",
      between(0, 1));
    v("redeskew_first_scan", self.redeskew_first_scan, "",
      "de-skew the first scan in the map with the motion estimated from the second (not in the "
      "published program)");
    v("pose_instant", self.pose_instant, "", "instant of the pose: scan_middle or scan_end");
    v("initial_threshold_m", self.initial_threshold_m, "m",
      "initial sigma of the prediction's error; the search radius is 3 sigma", above(0));
    v("min_motion_m", self.min_motion_m, "m",
      "smaller errors of the prediction do not enter sigma; with threshold_memory they enter as "
      "this value",
      at_least(0));
    v("threshold_start", self.threshold_start, "",
      "use of initial_threshold_m: blended: it always counts as one sample; until_moved: it is "
      "used alone up to 5 min_motion_m from the start, afterwards not at all");
    v("threshold_memory", self.threshold_memory, "registrations",
      "number after which an error's weight in sigma has fallen to 1/e (not in the published "
      "program); null: errors keep their weight",
      at_least(1));
    v("threshold_lever", self.threshold_lever, "",
      "range by which sigma converts rotation errors to meters: max_range, or mean_range of the "
      "keypoints (not in the published program)");
    v("plane_thinness", self.plane_thinness, "",
      "a cell counts as a plane if the variance of its points across the plane is at most this "
      "fraction of that along it; points are then matched along its normal only; null: no planes, "
      "as in the published program",
      between(0, 1));
    v("degenerate_cell_weight", self.degenerate_cell_weight, "",
      "with plane_thinness: weight of matches in cells with fewer than 5 points or with points on "
      "a line only. They show the scan pattern, not the surface; if the pattern repeats, they hold "
      "the estimate at the previous pose. Below 1: not in the published program",
      between(0, 1));
    v("map_thinning", self.map_thinning, "voxel sizes",
      "edge of the cells from each of which one point is offered to the map", above(0));
    v("initial_scans", self.initial_scans, "scans",
      "number of scans at the start that are neither cut nor de-skewed with their own motion, "
      "because the map is still too sparse to separate motion from noise; above 0: not in the "
      "published program",
      at_least(0));
    v("keypoint_thinning", self.keypoint_thinning, "voxel sizes",
      "edge of the cells from each of which one point is registered", above(0));
    v("kernel_fraction", self.kernel_fraction, "",
      "scale of the robust kernel as a fraction of sigma, see kernel_scale_in_meters", above(0));
    v("kernel_scale_in_meters", self.kernel_scale_in_meters, "",
      "the robust kernel's scale is a length, kernel_fraction times sigma (not in the published "
      "program); false: the square root of that, as in the program's formula");
    v("max_iterations", self.max_iterations, "",
      "maximum number of ICP iterations; bounds the time of a scan that does not converge",
      at_least(1));
    v("convergence", self.convergence, "m and rad", "ICP ends when the norm of its step is smaller",
      at_least(0));
    v("ignore_equal_times", self.ignore_equal_times, "",
      "register a scan whose points all have the same time without de-skewing; the published "
      "program drops all its points");
    v("motion_per_second", self.motion_per_second, "",
      "predict and de-skew by real time, so that a dropped scan causes no error; the published "
      "program counts scans");
    v("lost_motion_factor", self.lost_motion_factor, "",
      "factor on the predicted motion after each scan without matches; below 1: not in the "
      "published program",
      between(0, 1));
    v("sensor_centered", self.sensor_centered, "",
      "rotation increments are about the sensor; false: about the origin of the map, as in the "
      "published program");
  }
};

/// The program's own defaults.
Config published(const LidarInfo& lidar);
/// The program of 2025.
Config head(const LidarInfo& lidar);
/// What a user of the program would set for a small sensor in rooms and tunnels.
Config indoor(const LidarInfo& lidar);

constexpr auto enum_names(PoseInstant) {
  return std::array{std::pair{"scan_middle", PoseInstant::kScanMiddle},
                    std::pair{"scan_end", PoseInstant::kScanEnd}};
}

constexpr auto enum_names(ThresholdLever) {
  return std::array{std::pair{"max_range", ThresholdLever::kMaxRange},
                    std::pair{"mean_range", ThresholdLever::kMeanRange}};
}

constexpr auto enum_names(ThresholdStart) {
  return std::array{std::pair{"blended", ThresholdStart::kBlended},
                    std::pair{"until_moved", ThresholdStart::kUntilMoved}};
}

}  // namespace lidarena::odometry::kiss_icp
