// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/trajectory/compat_evo.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "lidarena/base/angle.hpp"
#include "lidarena/base/so3.hpp"
#include "lidarena/results/summary.hpp"

namespace lidarena::evaluation {
namespace {

constexpr const char* kPlace = "evo";
using IndexPairs = std::vector<std::pair<std::size_t, std::size_t>>;

/// Stamps as evo stores them: the double nearest to the decimal seconds.
std::vector<double> seconds_of(std::span<const StampedPose> trajectory) {
  std::vector<double> seconds;
  seconds.reserve(trajectory.size());
  for (const StampedPose& pose : trajectory) {
    // a mantissa of 64 bits holds every count exactly, so that only the division rounds
    seconds.push_back(static_cast<double>(static_cast<long double>(pose.stamp.count()) / 1e9L));
  }
  return seconds;
}

/// The first index with the minimum of |stamps[i] - t|; `stamps` do not decrease.
std::size_t nearest(const std::vector<double>& stamps, double t) {
  const auto after = std::lower_bound(stamps.begin(), stamps.end(), t);
  if (after == stamps.begin()) return 0;
  const auto i = static_cast<std::size_t>(after - stamps.begin());
  if (after != stamps.end() && t - stamps[i - 1] > stamps[i] - t) return i;
  return static_cast<std::size_t>(std::ranges::lower_bound(stamps, stamps[i - 1]) - stamps.begin());
}

// --- alignment

/// evo requires two singular values of the positions' covariance above this, whatever their unit.
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

Similarity fit(std::span<const PosePair> pairs, const EvoOptions& o) {
  const std::size_t n = o.n_to_align == 0 ? pairs.size() : std::min(o.n_to_align, pairs.size());
  const Similarity found = umeyama(pairs.first(n), o.scale);
  if (!(found.singular_values[1] > kEpsilon)) {
    throw InputError(kPlace,
                     fmt::format("the first {} poses lie on a line or a point: the alignment is "
                                 "not determined",
                                 n),
                     "align only the origin (--origin), or more poses (--n-to-align)");
  }
  if (o.align) return found;
  Similarity scaled;
  scaled.scale = found.scale;
  return scaled;
}

Similarity alignment_of(std::span<const PosePair> pairs, const EvoOptions& o) {
  if (o.align || o.scale) return fit(pairs, o);
  Similarity placed;
  if (!o.align_origin) return placed;
  const Pose q_from_p = pairs[0].truth * pairs[0].estimate.inverse();
  placed.rotation = q_from_p.linear();
  placed.translation = q_from_p.translation();
  return placed;
}

std::vector<Pose> moved(std::span<const PosePair> pairs, const Similarity& a) {
  std::vector<Pose> poses;
  poses.reserve(pairs.size());
  for (const PosePair& pair : pairs) {
    const Eigen::Vector3d p = a.scale * pair.estimate.translation();
    poses.push_back(make_pose(Eigen::Matrix3d(a.rotation * pair.estimate.linear()),
                              a.rotation * p + a.translation));
  }
  return poses;
}

// --- pieces

/// Path length (m) or rotation angle (rad) from each pose to the next.
std::vector<double> steps_of(std::span<const Pose> poses, bool by_path) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Pose& a = poses[i - 1];
    const Pose& b = poses[i];
    steps.push_back(by_path ? (b.translation() - a.translation()).norm()
                            : so3::angle(a.linear().transpose() * b.linear()));
  }
  return steps;
}

/// Poses at which the sum of steps since the last such pose reaches `delta`.
std::vector<std::size_t> marks_of(const std::vector<double>& steps, double delta) {
  std::vector<std::size_t> marks;
  double sum = 0.0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    sum += steps[i];
    if (sum < delta) continue;
    marks.push_back(i + 1);
    sum = 0.0;
  }
  return marks;
}

IndexPairs between_marks(const std::vector<std::size_t>& marks) {
  IndexPairs pieces;
  for (std::size_t i = 1; i < marks.size(); ++i) pieces.emplace_back(marks[i - 1], marks[i]);
  return pieces;
}

IndexPairs pieces_of_frames(std::size_t poses, std::size_t delta, bool all_pairs) {
  IndexPairs pieces;
  for (std::size_t i = 0; i + delta < poses; i += all_pairs ? 1 : delta) {
    pieces.emplace_back(i, i + delta);
  }
  return pieces;
}

/// Pairs each pose with the one at the path length nearest to `delta`, if within `tolerance`.
IndexPairs all_pairs_by_path(std::span<const Pose> poses, double delta, double tolerance) {
  std::vector<double> s{0.0};
  for (const double step : steps_of(poses, true)) s.push_back(s.back() + step);
  IndexPairs pieces;
  for (std::size_t i = 0; i + 1 < s.size(); ++i) {
    std::size_t best = i + 1;
    const auto off = [&](std::size_t j) { return std::abs(s[j] - s[i] - delta); };
    for (std::size_t j = i + 2; j < s.size() && s[j - 1] - s[i] < delta; ++j) {
      if (off(j) < off(best)) best = j;
    }
    if (off(best) <= tolerance) pieces.emplace_back(i, best);
  }
  return pieces;
}

/// All pairs of poses whose rotations differ by `delta`, within `tolerance`.
IndexPairs all_pairs_by_angle(std::span<const Pose> poses, double delta, double tolerance) {
  IndexPairs pieces;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    for (std::size_t j = i + 1; j < poses.size(); ++j) {
      const double turn = so3::angle(poses[i].linear().transpose() * poses[j].linear());
      if (std::abs(turn - delta) <= tolerance) pieces.emplace_back(i, j);
    }
  }
  return pieces;
}

void check_delta(const EvoOptions& o) {
  if (!(o.delta > 0.0) || !std::isfinite(o.delta)) {
    throw InputError(kPlace, fmt::format("delta is {}, not a positive number", o.delta));
  }
  if (!(o.delta_tolerance >= 0.0)) {
    throw InputError(kPlace, "the tolerance of delta is negative");
  }
  if (o.unit == EvoUnit::kFrames && o.delta != std::floor(o.delta)) {
    throw InputError(kPlace, fmt::format("delta is {}, not a whole number of frames", o.delta));
  }
  const double max_delta = o.unit == EvoUnit::kDegrees ? 180.0 : std::numbers::pi;
  if ((o.unit == EvoUnit::kDegrees || o.unit == EvoUnit::kRadians) && o.delta > max_delta) {
    throw InputError(kPlace, "delta is more than 180 degrees");
  }
}

// --- errors

double frobenius(const Eigen::Matrix3d& r) { return (r - Eigen::Matrix3d::Identity()).norm(); }

/// The `relation` of E = `a`^-1 `b`.
double error_of(const Pose& a, const Pose& b, EvoRelation relation) {
  const Eigen::Matrix3d r = a.linear().transpose() * b.linear();
  const double distance = (a.translation() - b.translation()).norm();
  switch (relation) {
    case EvoRelation::kRotation:
      return frobenius(r);
    case EvoRelation::kFull:
      return std::hypot(frobenius(r), distance);
    case EvoRelation::kAngleDegrees:
      return so3::angle(r) / kDegree;
    case EvoRelation::kAngleRadians:
      return so3::angle(r);
    default:
      return distance;
  }
}

std::vector<double> absolute_errors(std::span<const Pose> reference, std::span<const Pose> estimate,
                                    EvoRelation relation) {
  std::vector<double> errors;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    errors.push_back(error_of(estimate[i], reference[i], relation));
  }
  return errors;
}

std::vector<double> relative_errors(std::span<const Pose> reference, std::span<const Pose> estimate,
                                    const IndexPairs& pieces, EvoRelation relation) {
  std::vector<double> errors;
  for (const auto& [begin, end] : pieces) {
    const Pose q = reference[begin].inverse() * reference[end];
    const Pose p = estimate[begin].inverse() * estimate[end];
    const double difference = std::abs(q.translation().norm() - p.translation().norm());
    if (relation == EvoRelation::kPointDistance) {
      errors.push_back(difference);
    } else if (relation == EvoRelation::kPointDistanceRatio) {
      const double chord = q.translation().norm();
      if (chord > 0.0) errors.push_back(100.0 * difference / chord);
    } else {
      errors.push_back(error_of(q, p, relation));
    }
  }
  return errors;
}

EvoStatistics statistics_of(const std::vector<double>& errors) {
  EvoStatistics s;
  const auto n = static_cast<double>(errors.size());
  s.min = s.max = errors.front();
  for (const double error : errors) {
    s.mean += error / n;
    s.sse += error * error;
    s.min = std::min(s.min, error);
    s.max = std::max(s.max, error);
  }
  for (const double error : errors) s.std += (error - s.mean) * (error - s.mean) / n;
  s.std = std::sqrt(s.std);
  s.rmse = std::sqrt(s.sse / n);
  std::vector<double> sorted = errors;
  s.median = results::quantile(sorted, 0.5);
  return s;
}

std::vector<PosePair> matched(std::span<const StampedPose> reference,
                              std::span<const StampedPose> estimate, const EvoOptions& o) {
  std::vector<PosePair> pairs;
  for (const auto& [i, j] : evo_association(reference, estimate, o.max_difference_s, o.offset_s)) {
    pairs.push_back(
        {reference[i].stamp, reference[i].world_from_body, estimate[j].world_from_body});
  }
  if (pairs.empty()) {
    throw InputError(kPlace,
                     fmt::format("no stamps are within {} s of each other", o.max_difference_s),
                     "check the clocks, or raise --t-max-diff or --t-offset");
  }
  return pairs;
}

void check_options(const EvoOptions& o) {
  if (!(o.max_difference_s >= 0.0) || !std::isfinite(o.offset_s)) {
    throw InputError(kPlace,
                     "the maximum difference of stamps is negative, or their offset not finite");
  }
  if (o.align_origin && (o.align || o.scale)) {
    throw InputError(kPlace, "--origin cannot be combined with --align or --scale", "choose one");
  }
  if (o.metric == EvoMetric::kApe && o.relation == EvoRelation::kPointDistanceRatio) {
    throw InputError(kPlace, "point_distance_error_ratio is defined for the metric rpe only");
  }
}

}  // namespace

const char* unit_of(EvoRelation relation) {
  switch (relation) {
    case EvoRelation::kTranslation:
    case EvoRelation::kPointDistance:
      return "m";
    case EvoRelation::kAngleDegrees:
      return "deg";
    case EvoRelation::kAngleRadians:
      return "rad";
    case EvoRelation::kPointDistanceRatio:
      return "%";
    default:
      return "";
  }
}

IndexPairs evo_association(std::span<const StampedPose> reference,
                           std::span<const StampedPose> estimate, double max_difference_s,
                           double offset_s) {
  const bool estimate_is_longer = estimate.size() > reference.size();
  const std::vector<double> q = seconds_of(reference);
  const std::vector<double> p = seconds_of(estimate);
  const std::vector<double>& shorter = estimate_is_longer ? q : p;
  std::vector<double> longer = estimate_is_longer ? p : q;
  for (double& t : longer) t += estimate_is_longer ? offset_s : -offset_s;
  IndexPairs pairs;
  for (std::size_t i = 0; i < shorter.size() && !longer.empty(); ++i) {
    const std::size_t j = nearest(longer, shorter[i]);
    if (!(std::abs(longer[j] - shorter[i]) <= max_difference_s)) continue;
    pairs.push_back(estimate_is_longer ? std::pair{i, j} : std::pair{j, i});
  }
  return pairs;
}

IndexPairs evo_pieces(std::span<const Pose> poses, const EvoOptions& o) {
  check_delta(o);
  if (o.unit == EvoUnit::kFrames) {
    if (o.delta >= static_cast<double>(poses.size())) return {};
    return pieces_of_frames(poses.size(), static_cast<std::size_t>(o.delta), o.all_pairs);
  }
  const bool by_path = o.unit == EvoUnit::kMeters;
  const double delta = o.unit == EvoUnit::kDegrees ? o.delta * kDegree : o.delta;
  if (o.all_pairs) {
    const double tolerance = delta * o.delta_tolerance;
    return by_path ? all_pairs_by_path(poses, delta, tolerance)
                   : all_pairs_by_angle(poses, delta, tolerance);
  }
  std::vector<std::size_t> marks = marks_of(steps_of(poses, by_path), delta);
  if (!by_path) marks.insert(marks.begin(), 0);  // pieces by angle start at the first pose
  return between_marks(marks);
}

EvoResult compat_evo(std::span<const StampedPose> reference, std::span<const StampedPose> estimate,
                     const EvoOptions& o) {
  check_options(o);
  const std::vector<PosePair> pairs = matched(reference, estimate, o);
  EvoResult result;
  result.matched = pairs.size();
  result.reference_from_estimate = alignment_of(pairs, o);
  std::vector<Pose> q;
  for (const PosePair& pair : pairs) q.push_back(pair.truth);
  const std::vector<Pose> p = moved(pairs, result.reference_from_estimate);
  if (o.metric == EvoMetric::kApe) {
    result.errors = absolute_errors(q, p, o.relation);
  } else {
    const IndexPairs pieces = evo_pieces(o.pairs_from_reference ? q : p, o);
    result.errors = relative_errors(q, p, pieces, o.relation);
  }
  if (result.errors.empty()) {
    throw InputError(kPlace, "no two poses are as far apart as delta",
                     "lower --delta, or raise --delta-tolerance");
  }
  result.statistics = statistics_of(result.errors);
  return result;
}

}  // namespace lidarena::evaluation
