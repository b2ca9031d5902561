// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/trajectory_error.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lidarena/base/error.hpp"
#include "lidarena/base/so3.hpp"

namespace lidarena {
namespace {

// Rounding of a path summed over 1e5 poses with 9 significant digits stays under this; a last piece
// may be shorter by as much.
constexpr double kLengthSlack = 1e-6;

struct TimeSpan {
  Time begin{0};
  Time end{0};
};

/// Empty (end < begin) when the trajectories do not meet.
TimeSpan common_span(const Trajectory& a, const Trajectory& b) {
  if (a.empty() || b.empty()) return {Time{0}, Time{-1}};
  return {std::max(a.begin_time(), b.begin_time()), std::min(a.end_time(), b.end_time())};
}

/// Arc length s(t) at the truth's stamps within a span.
struct ArcLength {
  std::vector<Time> t;
  std::vector<double> s;
};

ArcLength arc_length(const Trajectory& truth, TimeSpan span) {
  ArcLength arc;
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  for (const StampedPose& pose : truth.poses()) {
    if (pose.stamp < span.begin || pose.stamp > span.end) continue;
    const Eigen::Vector3d& position = pose.world_from_body.translation();
    arc.s.push_back(arc.t.empty() ? 0.0 : arc.s.back() + (position - last).norm());
    arc.t.push_back(pose.stamp);
    last = position;
  }
  return arc;
}

/// The first instant at which the path is `s` long.
Time time_at(const ArcLength& arc, double s) {
  const auto next = std::lower_bound(arc.s.begin(), arc.s.end(), s);
  if (next == arc.s.begin()) return arc.t.front();
  if (next == arc.s.end()) return arc.t.back();
  const auto i = static_cast<std::size_t>(next - arc.s.begin());
  const double share = (s - arc.s[i - 1]) / (arc.s[i] - arc.s[i - 1]);
  const auto step = static_cast<double>((arc.t[i] - arc.t[i - 1]).count());
  return arc.t[i - 1] + Time{std::llround(share * step)};
}

/// How many pieces of `segment`, starting every `step`, fit into `length`.
std::size_t count_pieces(double length, double segment, double step) {
  const double room = length + kLengthSlack - segment;
  return room < 0.0 ? 0 : static_cast<std::size_t>(room / step) + 1;
}

std::vector<TimeSpan> pieces_of_path(const ArcLength& arc, double segment_m, double step_m) {
  std::vector<TimeSpan> pieces(arc.s.empty() ? 0 : count_pieces(arc.s.back(), segment_m, step_m));
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const double start = static_cast<double>(k) * step_m;
    pieces[k] = {time_at(arc, start), time_at(arc, start + segment_m)};
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
std::optional<Pose> motion_over(const Trajectory& trajectory, TimeSpan piece, Time bracket) {
  const std::optional<Pose> a = pose_between(trajectory, piece.begin, bracket);
  const std::optional<Pose> b = pose_between(trajectory, piece.end, bracket);
  if (!a || !b) return std::nullopt;
  return a->inverse() * *b;
}

/// E = (Q_a^-1 Q_b)^-1 (P_a^-1 P_b) of each piece (paper eq. 1), and their statistics.
RelativePoseError score(const Trajectory& estimate, const Trajectory& truth,
                        const std::vector<TimeSpan>& pieces) {
  const Time estimate_bracket = max_bracket(estimate);
  const Time truth_bracket = max_bracket(truth);
  RelativePoseError rpe;
  std::vector<double> translations;
  std::vector<double> rotations;
  for (const TimeSpan& piece : pieces) {
    const std::optional<Pose> q = motion_over(truth, piece, truth_bracket);
    const std::optional<Pose> p = motion_over(estimate, piece, estimate_bracket);
    if (!q || !p) continue;
    const Pose error = q->inverse() * *p;
    translations.push_back(error.translation().norm());
    rotations.push_back(so3::angle(error.linear()));
    rpe.segments.push_back({piece.begin, piece.end, translations.back(), rotations.back()});
  }
  rpe.used = rpe.segments.size();
  rpe.total = pieces.size();
  rpe.translation_m = summarize(translations);
  rpe.rotation_rad = summarize(rotations);
  return rpe;
}

void require_positive(double value, const char* name) {
  if (!(value > 0.0) || !std::isfinite(value)) {
    throw InputError(name, "is not a positive number", "give a length above zero");
  }
}

}  // namespace

RelativePoseError relative_pose_error(const Trajectory& estimate, const Trajectory& truth,
                                      double segment_m, double step_m) {
  require_positive(segment_m, "segment_m");
  require_positive(step_m, "step_m");
  const ArcLength arc = arc_length(truth, common_span(estimate, truth));
  RelativePoseError rpe = score(estimate, truth, pieces_of_path(arc, segment_m, step_m));
  rpe.segment_m = segment_m;
  rpe.step = step_m;
  return rpe;
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
                                                  const Trajectory& truth, Gauge gauge) {
  const std::vector<PosePair> pairs = matched_poses(estimate, truth);
  AbsoluteTrajectoryError ate;
  ate.alignment = align(pairs, gauge);
  if (!ate.alignment.determined()) return ate;
  std::vector<double> translations;
  std::vector<double> rotations;
  for (const PosePair& pair : pairs) {
    const Pose aligned = ate.alignment.truth_from_estimate * pair.estimate;
    translations.push_back((pair.truth.translation() - aligned.translation()).norm());
    rotations.push_back(so3::angle(aligned.linear().transpose() * pair.truth.linear()));
    ate.poses.push_back({pair.stamp, translations.back(), rotations.back()});
  }
  ate.translation_m = summarize(translations);
  ate.rotation_rad = summarize(rotations);
  return ate;
}

}  // namespace lidarena
