// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "lidarena/base/pose.hpp"
#include "lidarena/results/summary.hpp"

/// Scores of one trajectory against the truth. docs/metrics.md defines each by its `definition`. A
/// figure that does not exist is empty here and null in JSON, never zero or NaN.
namespace lidarena::results {

/// Pose of the estimate's body frame in the truth's, as the two motions suggest.
struct LeverArmMetrics {
  std::array<std::optional<double>, 3> position_m, rotation_vector_rad;  ///< empty: not observable
  std::array<double, 3> position_sigma_m{}, rotation_sigma_rad{};
  double misfit_without_m = 0.0, misfit_m = 0.0;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("position_m", self.position_m, "m",
      "in the truth's body frame; null with a sigma above 10 cm");
    v("position_sigma_m", self.position_sigma_m, "m", "formal standard deviation");
    v("rotation_vector_rad", self.rotation_vector_rad, "rad", "null with a sigma above 0.1 rad");
    v("rotation_sigma_rad", self.rotation_sigma_rad, "rad", "formal standard deviation");
    v("misfit_without_m", self.misfit_without_m, "m", "RMS difference of motions over 1 s");
    v("misfit_m", self.misfit_m, "m", "the same with the arm");
  }
};

/// How well the two trajectories can be compared.
struct AssociationMetrics {
  std::size_t estimates = 0, matched = 0;
  double coverage = 0.0;
  double overlap_s = 0.0, longest_gap_s = 0.0;
  double estimate_rate_hz = 0.0, truth_rate_hz = 0.0;
  std::optional<double> time_offset_s, time_offset_sigma_s;
  std::optional<LeverArmMetrics> lever_arm;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("estimates", self.estimates, "", "poses of the estimate");
    v("matched", self.matched, "", "those with a true pose at their instant");
    v("coverage", self.coverage, "", "share of the flight between estimates without a gap, 0..1");
    v("overlap_s", self.overlap_s, "s", "common time span");
    v("longest_gap_s", self.longest_gap_s, "s", "between consecutive estimates");
    v("estimate_rate_hz", self.estimate_rate_hz, "Hz", "1 / median period");
    v("truth_rate_hz", self.truth_rate_hz, "Hz", "1 / median period");
    v("time_offset_s", self.time_offset_s, "s", "the estimate's stamps are late; not corrected");
    v("time_offset_sigma_s", self.time_offset_sigma_s, "s", "formal standard deviation");
    v("lever_arm", self.lever_arm, "", "a diagnostic, not applied");
  }
};

/// The error of a perfect estimate at the same instants: interpolation alone.
struct RpeFloor {
  double translation_rmse_m = 0.0, rotation_rmse_rad = 0.0;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("translation_rmse_m", self.translation_rmse_m, "m", "");
    v("rotation_rmse_rad", self.rotation_rmse_rad, "rad", "");
  }
};

/// Relative pose error over pieces of one length or duration.
struct RpeMetrics {
  std::string definition;
  std::optional<double> segment_m, segment_s;
  std::size_t used = 0, total = 0;
  SummaryInMeters translation;
  SummaryInRadians rotation;
  std::optional<RpeFloor> floor;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("definition", self.definition, "", "id in docs/metrics.md");
    v("segment_m", self.segment_m, "m", "length of a piece of the true path, or");
    v("segment_s", self.segment_s, "s", "its duration");
    v("used", self.used, "", "pieces scored");
    v("total", self.total, "", "pieces in the common time span");
    v("translation", self.translation, "", "");
    v("rotation", self.rotation, "", "");
    v("floor", self.floor, "", "error of a perfect estimate at the same instants");
  }
};

/// Relative pose error at the constant time offset for which it is least.
struct RpeAtOffset {
  double late_s = 0.0;
  RpeMetrics rpe;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("late_s", self.late_s, "s", "how much later the estimate's stamps are than the truth's");
    v("rpe", self.rpe, "", "with the stamps corrected by it");
  }
};

/// Lengths (m) of the pieces over which the RPE and KITTI's short rule are computed.
inline constexpr std::array kRpeLengths_m{1.0, 2.0, 5.0, 10.0, 20.0, 50.0};

struct RpeByLength {
  std::array<RpeMetrics, kRpeLengths_m.size()> lengths;  ///< of kRpeLengths_m
  RpeMetrics at_poses_1m, over_1s;
  std::optional<RpeAtOffset> at_best_offset_1m;  ///< empty without pieces
  /// Empty where the LiDAR's clock has no offset and no drift, or is not known.
  std::optional<RpeMetrics> at_lidar_clock_1m;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    constexpr std::array kNames{"1m", "2m", "5m", "10m", "20m", "50m"};
    static_assert(kNames.size() == kRpeLengths_m.size());
    for (std::size_t i = 0; i < kNames.size(); ++i) {
      v(kNames[i], self.lengths[i], "", "ends interpolated");
    }
    v("1m_at_poses", self.at_poses_1m, "", "from pose to pose of the estimate");
    v("1s", self.over_1s, "", "pieces of one second");
    v("1m_at_best_offset", self.at_best_offset_1m, "",
      "1m_at_poses at the constant time offset for which it is least; a diagnostic");
    v("1m_at_lidar_clock", self.at_lidar_clock_1m, "",
      "1m_at_poses with the truth's times as the LiDAR's clock shows them");
  }
};

/// Absolute trajectory error in one alignment.
struct AteMetrics {
  std::string definition;
  std::optional<std::string> refused;
  std::optional<Pose> truth_from_estimate;
  std::optional<double> scale_hint;
  std::optional<std::string> warning;
  SummaryInMeters translation;
  SummaryInRadians rotation;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("definition", self.definition, "", "id in docs/metrics.md");
    v("refused", self.refused, "", "why the alignment is not determined");
    v("truth_from_estimate_m_quaternion", self.truth_from_estimate, "m", "x y z qx qy qz qw");
    v("scale_hint", self.scale_hint, "", "scale of a similarity fit; not applied");
    v("warning", self.warning, "", "");
    v("translation", self.translation, "", "");
    v("rotation", self.rotation, "", "");
  }
};

struct AteByAlignment {
  AteMetrics first_pose, se3, posyaw;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("first_pose", self.first_pose, "", "the first common pose; nothing is fitted");
    v("se3", self.se3, "", "least squares over all positions");
    v("posyaw", self.posyaw, "", "position and heading only");
  }
};

/// KITTI's error of the pieces of one length.
struct KittiLength {
  double length_m = 0.0;
  std::size_t pieces = 0;
  std::optional<double> translation_percent, rotation_rad_per_m;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("length_m", self.length_m, "m", "");
    v("pieces", self.pieces, "", "");
    v("translation_percent", self.translation_percent, "%", "mean, of the length");
    v("rotation_rad_per_m", self.rotation_rad_per_m, "rad/m", "mean");
  }
};

/// KITTI's odometry error over all lengths together.
struct KittiError {
  std::string definition;
  std::optional<std::string> refused;
  std::size_t pieces = 0;
  std::optional<double> translation_percent, rotation_rad_per_m;
  std::vector<KittiLength> lengths;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("definition", self.definition, "", "id in docs/metrics.md");
    v("refused", self.refused, "", "why there is no figure");
    v("pieces", self.pieces, "", "of all lengths together");
    v("translation_percent", self.translation_percent, "%", "mean, of the length");
    v("rotation_rad_per_m", self.rotation_rad_per_m, "rad/m", "mean");
    v("lengths", self.lengths, "", "");
  }
};

/// Jitter of the estimated position while the body hovers.
struct HoverJitter {
  static constexpr double kSpeed_mps = 0.05;  ///< in a hover the truth is slower than this ...
  static constexpr double kMin_s = 1.0;       ///< ... for at least this long
  std::string definition = "hover_jitter[below5cm/s,1s,about-mean]";
  double seconds = 0.0;  ///< total duration of the hovers
  std::size_t poses = 0;
  double rms_m = 0.0;  ///< of the position error about its mean over each hover
  bool empty() const { return poses == 0; }

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("definition", self.definition, "", "id in docs/metrics.md");
    v("hovered_s", self.seconds, "s", "total duration of the hovers");
    v("poses", self.poses, "", "");
    v("rms_m", self.rms_m, "m", "of the position error about its mean over each hover");
  }
};

/// Columns; each row is the largest error of `largest_of` consecutive ones, so that no peak is
/// lost.
struct ErrorsOverTime {
  static constexpr const char* kTitle = "ErrorsOverTime";
  std::vector<double> t_s, translation_m, rotation_rad;
  std::size_t largest_of = 1;
  bool empty() const { return t_s.empty(); }

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("t_s", self.t_s, "s", "since the truth's first pose");
    v("translation_m", self.translation_m, "m", "");
    v("rotation_rad", self.rotation_rad, "rad", "");
    v("largest_of", self.largest_of, "", "consecutive errors behind one row");
  }
};

struct ErrorCurves {
  ErrorsOverTime rpe_1m, ate_first_pose, ate_se3;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("rpe_1m", self.rpe_1m, "", "of the pieces from pose to pose");
    v("ate_first_pose", self.ate_first_pose, "", "");
    v("ate_se3", self.ate_se3, "", "");
  }
};

/// All scores of one trajectory. Without the status "ok" there is the association alone.
struct TrajectoryMetrics {
  std::string status = "ok";
  std::string reason;
  AssociationMetrics association;
  std::optional<RpeByLength> rpe;
  std::optional<AteByAlignment> ate;
  std::optional<KittiError> kitti, kitti_short;
  HoverJitter hover_jitter;
  std::optional<ErrorCurves> errors_over_time;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("status", self.status, "", "ok, diverged, no_output, no_overlap");
    v("reason", self.reason, "", "");
    v("association", self.association, "", "");
    v("rpe", self.rpe, "", "relative pose error");
    v("ate", self.ate, "", "absolute trajectory error");
    v("kitti", self.kitti, "", "KITTI's rule, 100 to 800 m");
    v("kitti_short", self.kitti_short, "", "KITTI's rule, 1 to 50 m");
    v("hover_jitter", self.hover_jitter, "", "");
    v("errors_over_time", self.errors_over_time, "", "");
  }
};

}  // namespace lidarena::results
