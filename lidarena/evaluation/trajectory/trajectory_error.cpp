// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/trajectory/trajectory_error.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <utility>

#include "lidarena/base/error.hpp"
#include "lidarena/base/so3.hpp"
#include "lidarena/evaluation/trajectory/arc_length.hpp"

namespace lidarena::evaluation {
namespace {

// More than the rounding of a path summed over 1e5 poses with 9 significant digits (m or s); the
// last piece may be shorter by this much.
constexpr double kLengthSlack = 1e-6;

/// How many pieces of `segment`, starting every `step`, fit into `length`.
std::size_t count_pieces(double length, double segment, double step) {
  const double room = length + kLengthSlack - segment;
  return room < 0.0 ? 0 : static_cast<std::size_t>(room / step) + 1;
}

std::vector<TimeSpan> pieces_of_path(const ArcLength& arc, double segment_m, double step_m) {
  std::vector<TimeSpan> pieces(arc.empty() ? 0 : count_pieces(arc.length(), segment_m, step_m));
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const double start = static_cast<double>(k) * step_m;
    pieces[k] = {arc.time_at(start), arc.time_at(start + segment_m)};
  }
  return pieces;
}

std::vector<TimeSpan> pieces_of_time(TimeSpan span, double segment_s, double step_s) {
  std::vector<TimeSpan> pieces(count_pieces(to_seconds(span.end - span.begin), segment_s, step_s));
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const Time start = span.begin + from_seconds(static_cast<double>(k) * step_s);
    pieces[k] = {start, std::min(start + from_seconds(segment_s), span.end)};
  }
  return pieces;
}

/// The motion over a piece, in the frame of its start; empty when an end lies in a gap.
std::optional<Pose> motion_over(const Trajectory& trajectory, TimeSpan piece, Time gap_limit) {
  const std::optional<Pose> a = pose_between(trajectory, piece.begin, gap_limit);
  const std::optional<Pose> b = pose_between(trajectory, piece.end, gap_limit);
  if (!a || !b) return std::nullopt;
  return a->inverse() * *b;
}

/// Stamp of the estimate's pose nearest to an instant within its span.
Time nearest_stamp(const Trajectory& estimate, Time t) {
  const auto poses = estimate.poses();
  const auto after = std::lower_bound(poses.begin(), poses.end(), t,
                                      [](const StampedPose& p, Time x) { return p.stamp < x; });
  if (after == poses.begin()) return after->stamp;
  const Time before = std::prev(after)->stamp;
  return after == poses.end() || t - before <= after->stamp - t ? before : after->stamp;
}

/// E = (Q_a^-1 Q_b)^-1 (P_a^-1 P_b) of each piece (paper eq. 1), times its `factor`, and their
/// statistics.
RelativePoseError score(const Trajectory& estimate, const Trajectory& truth,
                        const std::vector<TimeSpan>& pieces,
                        const std::function<double(const TimeSpan&)>& factor = nullptr) {
  const Time estimate_gap_limit = gap_limit_of(estimate);
  const Time truth_gap_limit = gap_limit_of(truth);
  RelativePoseError rpe;
  std::vector<double> translations;
  std::vector<double> rotations;
  for (const TimeSpan& piece : pieces) {
    const std::optional<Pose> q = motion_over(truth, piece, truth_gap_limit);
    const std::optional<Pose> p = motion_over(estimate, piece, estimate_gap_limit);
    if (!q || !p) continue;
    const Pose error = q->inverse() * *p;
    const double by = factor ? factor(piece) : 1.0;
    translations.push_back(by * error.translation().norm());
    rotations.push_back(by * so3::angle(error.linear()));
    rpe.segments.push_back({piece.begin, piece.end, translations.back(), rotations.back()});
  }
  rpe.used = rpe.segments.size();
  rpe.total = pieces.size();
  rpe.translation_m = results::summarize(translations);
  rpe.rotation_rad = results::summarize(rotations);
  return rpe;
}

/// The poses with all stamps earlier by `late`.
Trajectory earlier(const Trajectory& trajectory, Time late) {
  std::vector<StampedPose> poses(trajectory.poses().begin(), trajectory.poses().end());
  for (StampedPose& pose : poses) pose.stamp -= late;
  return Trajectory(std::move(poses));
}

void require_positive(double value, const char* name) {
  if (!(value > 0.0) || !std::isfinite(value)) {
    throw InputError(name, "not a positive number", "give a value above zero");
  }
}

}  // namespace

RelativePoseError relative_pose_error(const Trajectory& estimate, const Trajectory& truth,
                                      double segment_m, double step_m) {
  require_positive(segment_m, "segment_m");
  require_positive(step_m, "step_m");
  const ArcLength arc(truth, common_span(estimate, truth));
  RelativePoseError rpe = score(estimate, truth, pieces_of_path(arc, segment_m, step_m));
  rpe.segment_m = segment_m;
  rpe.step = step_m;
  return rpe;
}

RelativePoseError relative_pose_error_at_poses(const Trajectory& estimate, const Trajectory& truth,
                                               double segment_m) {
  require_positive(segment_m, "segment_m");
  const ArcLength arc(truth, common_span(estimate, truth));
  const std::vector<TimeSpan> exact = pieces_of_path(arc, segment_m, segment_m);
  const Time gap_limit = gap_limit_of(estimate);
  std::vector<TimeSpan> pieces;
  for (const TimeSpan& piece : exact) {
    if (!pose_between(estimate, piece.begin, gap_limit) ||
        !pose_between(estimate, piece.end, gap_limit))
      continue;
    const TimeSpan moved{nearest_stamp(estimate, piece.begin), nearest_stamp(estimate, piece.end)};
    if (moved.begin < moved.end) pieces.push_back(moved);
  }
  RelativePoseError rpe = score(estimate, truth, pieces, [&](const TimeSpan& piece) {
    return segment_m / (arc.at(piece.end) - arc.at(piece.begin));
  });
  rpe.total = exact.size();
  rpe.segment_m = segment_m;
  rpe.step = segment_m;
  rpe.at_poses = true;
  return rpe;
}

std::optional<RpeAtBestOffset> relative_pose_error_at_best_offset(const Trajectory& estimate,
                                                                  const Trajectory& truth,
                                                                  double range_s) {
  std::optional<RpeAtBestOffset> best;  // of a grid of 10 ms, then of finer ones around it
  const std::size_t pieces = relative_pose_error_at_poses(estimate, truth).used;
  for (const double step_s : {1e-2, 1e-3, 1e-4}) {
    const double middle_s = best ? best->late_s : 0.0;
    for (int k = -10; k <= 10; ++k) {
      const double late_s = middle_s + k * step_s;
      if (std::abs(late_s) > range_s + 1e-9) continue;
      RelativePoseError rpe =
          relative_pose_error_at_poses(earlier(estimate, from_seconds(late_s)), truth);
      if (rpe.used == 0 || 2 * rpe.used < pieces) continue;
      if (!best || rpe.translation_m.rmse < best->rpe.translation_m.rmse)
        best = {late_s, range_s, std::move(rpe)};
    }
  }
  return best;
}

RelativePoseError relative_pose_error_over_time(const Trajectory& estimate, const Trajectory& truth,
                                                double segment_s, double step_s) {
  require_positive(segment_s, "segment_s");
  require_positive(step_s, "step_s");
  const TimeSpan span = common_span(estimate, truth);
  RelativePoseError rpe = score(estimate, truth, pieces_of_time(span, segment_s, step_s));
  rpe.segment_s = segment_s;
  rpe.step = step_s;
  return rpe;
}

AbsoluteTrajectoryError absolute_trajectory_error(const Trajectory& estimate,
                                                  const Trajectory& truth, AlignmentKind kind) {
  const std::vector<PosePair> pairs = matched_poses(estimate, truth);
  AbsoluteTrajectoryError ate;
  ate.alignment = align(pairs, kind);
  if (!ate.alignment.determined()) return ate;
  std::vector<double> translations;
  std::vector<double> rotations;
  for (const PosePair& pair : pairs) {
    const Pose aligned = ate.alignment.truth_from_estimate * pair.estimate;
    translations.push_back((pair.truth.translation() - aligned.translation()).norm());
    rotations.push_back(so3::angle(aligned.linear().transpose() * pair.truth.linear()));
    ate.poses.push_back({pair.stamp, translations.back(), rotations.back()});
  }
  ate.translation_m = results::summarize(translations);
  ate.rotation_rad = results::summarize(rotations);
  return ate;
}

}  // namespace lidarena::evaluation
