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

namespace lidarena::kiss_icp {

/// Which instant of the scan the pose belongs to, and all points are moved to.
enum class PoseInstant { kScanMiddle, kScanEnd };

/// What the adaptive threshold is before much motion was seen.
enum class ThresholdStart {
  kBlended,     ///< sigma0 counts as the first sample, always
  kUntilMoved,  ///< sigma0 alone until 5 minimum motions from the start, then samples alone
};

/// Lever arm of the adaptive threshold: how far a wrong angle moves points.
enum class ThresholdLever {
  kMaxRange,   ///< max_range_m
  kMeanRange,  ///< mean range of the scan's keypoints
};

/// The defaults are the public program's (2025); preset() changes them.
struct Config {
  double max_range_m = 100.0;
  double min_range_m = 0.0;
  std::optional<double> voxel_size_m;  ///< unset: max_range_m / 100
  int max_points_per_voxel = 20;
  bool min_spacing = true;
  VoxelRounding cell_rounding = VoxelRounding::kFloor;
  ThinningOrder thinning_order = ThinningOrder::kTeschnerPrime;

  int slices = 1;
  double slice_above_m = 0.0;
  bool deskew = true;
  double own_motion = 0.0;
  bool rebuild_start = false;
  PoseInstant pose_instant = PoseInstant::kScanEnd;

  double initial_threshold_m = 2.0;
  double min_motion_m = 0.1;
  ThresholdStart threshold_start = ThresholdStart::kBlended;
  std::optional<double> threshold_memory;
  ThresholdLever threshold_lever = ThresholdLever::kMaxRange;

  std::optional<double> plane_thinness;
  double shapeless_weight = 1.0;
  double map_thinning = 0.5;
  double keypoint_thinning = 1.5;
  int calm_start = 0;
  double kernel_fraction = 1.0;
  bool kernel_in_meters = false;
  int max_iterations = 500;
  double convergence = 1e-4;

  bool equal_times_are_no_times = false;
  bool motion_per_second = false;
  double motion_kept_when_lost = 1.0;
  bool sensor_centered = false;

  double voxel_size() const { return voxel_size_m.value_or(max_range_m / 100.0); }

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("max_range_m", self.max_range_m, "m",
      "farther points are dropped; also the local map's radius and the threshold's lever arm",
      above(0));
    v("min_range_m", self.min_range_m, "m", "nearer points are dropped", at_least(0));
    v("voxel_size_m", self.voxel_size_m, "m",
      "edge of a map cell, null: max_range_m / 100; finer is more accurate and slower", above(0));
    v("max_points_per_voxel", self.max_points_per_voxel, "", "points a map cell holds",
      Limits{1, 4096});
    v("min_spacing", self.min_spacing, "",
      "keep the points of a cell voxel_size / sqrt(max_points_per_voxel) apart; false: the first "
      "ones met");
    v("cell_rounding", self.cell_rounding, "",
      "how points fall into cells: floor; truncate: cells around x, y, z = 0 are twice as wide");
    v("thinning_order", self.thinning_order, "",
      "which points the second thinning meets first: mixed, teschner or teschner_prime");
    v("slices", self.slices, "",
      "cure above 1: parts that a scan is cut into by time, each registered on its own",
      Limits{1, 100});
    v("slice_above_m", self.slice_above_m, "m",
      "scans are cut while sigma is above this: a part of a scan is a weaker hold, and better only "
      "where motion changes fast",
      at_least(0));
    v("deskew", self.deskew, "", "undo the motion within the scan, where points carry times");
    v("own_motion", self.own_motion, "",
      "cure above 0: share of the scan's own motion, which moves keypoints anew in each iteration "
      "of ICP, in what it is de-skewed with; the rest is the motion before. Near 1 it swings",
      between(0, 1));
    v("rebuild_start", self.rebuild_start, "",
      "cure: the first scan is de-skewed with the motion that the second shows");
    v("pose_instant", self.pose_instant, "", "instant of the pose: scan_middle or scan_end");
    v("initial_threshold_m", self.initial_threshold_m, "m",
      "first guess of the prediction's error sigma; the search radius is 3 sigma", above(0));
    v("min_motion_m", self.min_motion_m, "m",
      "smaller errors of the prediction do not count into sigma", at_least(0));
    v("threshold_start", self.threshold_start, "", "blended or until_moved");
    v("threshold_memory", self.threshold_memory, "registrations",
      "cure: after so many, an error's share in sigma is down to 1/e; null: never forgotten",
      at_least(1));
    v("threshold_lever", self.threshold_lever, "",
      "what turns an angle into meters in sigma: max_range or, cure, mean_range of the keypoints");
    v("plane_thinness", self.plane_thinness, "",
      "cure: cells whose points vary across a plane by at most this part of their variance along "
      "it count as that plane, and points are drawn to it along its normal alone; null: no planes",
      between(0, 1));
    v("shapeless_weight", self.shapeless_weight, "",
      "cure below 1, where cells know planes: weight of matches in cells of fewer than 5 points or "
      "of a line of them; such points are the pattern's, and where that repeats they hold the "
      "sensor where it was",
      between(0, 1));
    v("map_thinning", self.map_thinning, "voxel sizes",
      "edge of the cells of which one point each is offered to the map", above(0));
    v("calm_start", self.calm_start, "scans",
      "cure above 0: so many scans are neither cut nor move with their own motion, as the map is "
      "too thin at first to tell motion from noise",
      at_least(0));
    v("keypoint_thinning", self.keypoint_thinning, "voxel sizes",
      "edge of the cells of which one point each is registered", above(0));
    v("kernel_fraction", self.kernel_fraction, "",
      "scale of the robust kernel as a fraction of sigma", above(0));
    v("kernel_in_meters", self.kernel_in_meters, "",
      "cure: the kernel's scale is that length; false: the root of it, as its formula has it");
    v("max_iterations", self.max_iterations, "", "of ICP; bounds the time of a lost scan",
      at_least(1));
    v("convergence", self.convergence, "m and rad", "ICP ends below this step", at_least(0));
    v("equal_times_are_no_times", self.equal_times_are_no_times, "",
      "cure: a scan whose times are all equal is not de-skewed, instead of being lost");
    v("motion_per_second", self.motion_per_second, "",
      "cure: predict and de-skew by real time, so that a dropped scan does no harm");
    v("motion_kept_when_lost", self.motion_kept_when_lost, "",
      "cure below 1: factor on the predicted motion after each scan that matches nothing",
      between(0, 1));
    v("sensor_centered", self.sensor_centered, "",
      "cure: increments turn about the sensor, not about the origin of the map");
  }
};

/// Names of preset(), the default first.
std::vector<std::string> preset_names();

/// Settings for a LiDAR: "improved"; "head" and "original", the public programs of 2025 and 2023.
/// Throws InputError for another name.
Config preset(const std::string& name, const LidarInfo& lidar);

}  // namespace lidarena::kiss_icp

namespace lidarena {

template <>
struct EnumNames<kiss_icp::PoseInstant> {
  static constexpr std::array names{std::pair{"scan_middle", kiss_icp::PoseInstant::kScanMiddle},
                                    std::pair{"scan_end", kiss_icp::PoseInstant::kScanEnd}};
};

template <>
struct EnumNames<kiss_icp::ThresholdLever> {
  static constexpr std::array names{std::pair{"max_range", kiss_icp::ThresholdLever::kMaxRange},
                                    std::pair{"mean_range", kiss_icp::ThresholdLever::kMeanRange}};
};

template <>
struct EnumNames<ThinningOrder> {
  static constexpr std::array names{std::pair{"mixed", ThinningOrder::kMixed},
                                    std::pair{"teschner", ThinningOrder::kTeschner},
                                    std::pair{"teschner_prime", ThinningOrder::kTeschnerPrime}};
};

template <>
struct EnumNames<kiss_icp::ThresholdStart> {
  static constexpr std::array names{
      std::pair{"blended", kiss_icp::ThresholdStart::kBlended},
      std::pair{"until_moved", kiss_icp::ThresholdStart::kUntilMoved}};
};

}  // namespace lidarena
