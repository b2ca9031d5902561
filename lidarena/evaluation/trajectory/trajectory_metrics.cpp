// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/trajectory/trajectory_metrics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lidarena/base/so3.hpp"

namespace lidarena::evaluation {
namespace {

double rounded(double value) { return std::round(value * 1e6) / 1e6; }

Time stamp_of(const SegmentError& error) { return error.end; }
Time stamp_of(const PoseError& error) { return error.stamp; }

template <class Error>
results::ErrorsOverTime columns(std::span<const Error> errors, Time start, std::size_t limit) {
  results::ErrorsOverTime curve;
  curve.largest_of = limit == 0 ? errors.size() + 1 : (errors.size() + limit - 1) / limit;
  for (std::size_t begin = 0; begin < errors.size(); begin += curve.largest_of) {
    const Error* worst = &errors[begin];
    double rotation_rad = 0.0;
    for (const Error& error :
         errors.subspan(begin, std::min(curve.largest_of, errors.size() - begin))) {
      if (error.translation_m > worst->translation_m) worst = &error;
      rotation_rad = std::max(rotation_rad, error.rotation_rad);
    }
    curve.t_s.push_back(rounded(to_seconds(stamp_of(*worst) - start)));
    curve.translation_m.push_back(rounded(worst->translation_m));
    curve.rotation_rad.push_back(rounded(rotation_rad));
  }
  return curve;
}

/// Three components, empty where the standard deviation is `limit` or more.
std::array<std::optional<double>, 3> known(const Eigen::Vector3d& value, const double* sigma,
                                           double limit) {
  std::array<std::optional<double>, 3> components;
  for (std::size_t i = 0; i < 3; ++i) {
    if (sigma[i] < limit) components[i] = value[static_cast<Eigen::Index>(i)];
  }
  return components;
}

results::LeverArmMetrics metrics_of(const LeverArm& arm) {
  constexpr double kKnown = 0.1;  // m and rad
  results::LeverArmMetrics metrics;
  const double* sigma = arm.sigma.data();
  metrics.position_m = known(arm.body_from_estimate.translation(), sigma, kKnown);
  metrics.rotation_vector_rad = known(so3::log(arm.body_from_estimate.linear()), sigma + 3, kKnown);
  std::copy_n(sigma, 3, metrics.position_sigma_m.begin());
  std::copy_n(sigma + 3, 3, metrics.rotation_sigma_rad.begin());
  metrics.misfit_without_m = arm.misfit_without_m;
  metrics.misfit_m = arm.misfit_m;
  return metrics;
}

}  // namespace

std::string definition_id(const RelativePoseError& rpe) {
  const bool by_path = rpe.segment_m > 0.0;
  const double segment = by_path ? rpe.segment_m : rpe.segment_s;
  const char* unit = by_path ? "m" : "s";
  const std::string spacing =
      rpe.step == segment ? "disjoint" : fmt::format("every{}{}", rpe.step, unit);
  if (rpe.at_poses)
    return fmt::format("rpe_{0}m_at_poses[ref-arc,{0}m,{1},nearest-poses,gap1.5]", segment,
                       spacing);
  return fmt::format("rpe_{0}{1}[{2},{0}{1},{3},interp,gap1.5]", segment, unit,
                     by_path ? "ref-arc" : "time", spacing);
}

std::string definition_id(const AbsoluteTrajectoryError& ate) {
  return fmt::format("ate_{}[est-stamps,ref-interp,gap1.5]", to_string(ate.alignment.kind));
}

results::AssociationMetrics metrics_of(const Association& association,
                                       const std::optional<TimeOffset>& offset,
                                       const std::optional<LeverArm>& arm) {
  results::AssociationMetrics metrics;
  metrics.estimates = association.estimates;
  metrics.matched = association.matched;
  metrics.coverage = association.coverage;
  metrics.overlap_s = association.overlap_s;
  metrics.longest_gap_s = association.longest_gap_s;
  metrics.estimate_rate_hz = association.estimate_rate_hz;
  metrics.truth_rate_hz = association.truth_rate_hz;
  if (offset) {
    metrics.time_offset_s = offset->late_s;
    metrics.time_offset_sigma_s = offset->sigma_s;
  }
  if (arm) metrics.lever_arm = metrics_of(*arm);
  return metrics;
}

results::RpeMetrics metrics_of(const RelativePoseError& rpe, const RelativePoseError* of_perfect) {
  results::RpeMetrics metrics;
  metrics.definition = definition_id(rpe);
  (rpe.segment_m > 0.0 ? metrics.segment_m : metrics.segment_s) =
      std::max(rpe.segment_m, rpe.segment_s);
  metrics.used = rpe.used;
  metrics.total = rpe.total;
  metrics.translation = rpe.translation_m;
  metrics.rotation = rpe.rotation_rad;
  if (of_perfect != nullptr && of_perfect->used > 0) {
    metrics.floor = {of_perfect->translation_m.rmse, of_perfect->rotation_rad.rmse};
  }
  return metrics;
}

results::RpeAtOffset metrics_of(const RpeAtBestOffset& best) {
  results::RpeAtOffset metrics{best.late_s, metrics_of(best.rpe)};
  metrics.rpe.definition =
      fmt::format("rpe_{0}m_at_best_offset[ref-arc,{0}m,disjoint,nearest-poses,gap1.5,within{1}ms]",
                  best.rpe.segment_m, 1e3 * best.range_s);
  return metrics;
}

results::RpeMetrics metrics_at_clock(const RelativePoseError& rpe) {
  results::RpeMetrics metrics = metrics_of(rpe);
  metrics.definition = fmt::format(
      "rpe_{0}m_at_lidar_clock[ref-arc,{0}m,disjoint,nearest-poses,gap1.5]", rpe.segment_m);
  return metrics;
}

results::AteMetrics metrics_of(const AbsoluteTrajectoryError& ate) {
  const Alignment& alignment = ate.alignment;
  results::AteMetrics metrics;
  metrics.definition = definition_id(ate);
  if (alignment.determined()) {
    metrics.truth_from_estimate = alignment.truth_from_estimate;
    metrics.scale_hint = alignment.scale_hint;
  } else {
    metrics.refused = alignment.refusal;
  }
  if (!alignment.warning.empty()) metrics.warning = alignment.warning;
  metrics.translation = ate.translation_m;
  metrics.rotation = ate.rotation_rad;
  return metrics;
}

results::ErrorsOverTime errors_over_time(std::span<const SegmentError> segments, Time start,
                                         std::size_t limit) {
  return columns(segments, start, limit);
}

results::ErrorsOverTime errors_over_time(std::span<const PoseError> poses, Time start,
                                         std::size_t limit) {
  return columns(poses, start, limit);
}

}  // namespace lidarena::evaluation
