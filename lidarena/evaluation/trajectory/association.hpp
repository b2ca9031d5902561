// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "lidarena/base/trajectory.hpp"

namespace lidarena::evaluation {

/// How well two trajectories can be compared (overlap, coverage, rates); printed before any error.
struct Association {
  std::size_t estimates = 0;  ///< poses of the estimate
  std::size_t truths = 0;     ///< poses of the truth
  std::size_t matched = 0;    ///< estimates with a truth pose at their stamp, see matched_poses()
  /// Share of the truth's duration, 0..1, that lies between two consecutive estimates without a
  /// gap, see gap_limit_of().
  double coverage = 0.0;
  double overlap_s = 0.0;         ///< length of the common time span
  double longest_gap_s = 0.0;     ///< longest time between consecutive estimates
  double estimate_rate_hz = 0.0;  ///< 1 / median period; 0 with fewer than two poses
  double truth_rate_hz = 0.0;
};
Association associate(const Trajectory& estimate, const Trajectory& truth);

/// Median time between consecutive poses; zero with fewer than two.
Time median_period(const Trajectory& trajectory);

/// 1.5 median periods: two consecutive poses farther apart than this have a gap between them,
/// across which nothing is interpolated.
Time gap_limit_of(const Trajectory& trajectory);

/// Trajectory::at, but empty inside gaps longer than `gap_limit`.
std::optional<Pose> pose_between(const Trajectory& trajectory, Time t, Time gap_limit);

/// Poses of truth and estimate at one instant.
struct PosePair {
  Time stamp{0};
  Pose truth = Pose::Identity();
  Pose estimate = Pose::Identity();
};

/// Each pose of the estimate with the truth interpolated at its stamp; poses outside the truth's
/// time span or in one of its gaps are left out.
std::vector<PosePair> matched_poses(const Trajectory& estimate, const Trajectory& truth);

/// Whether the truth has longer periods than the estimate: interpolating it would be an error of a
/// perfect estimate.
bool is_coarser(const Trajectory& truth, const Trajectory& estimate);
/// The estimate interpolated at the stamps of the truth, outside its own gaps.
Trajectory at_truth_stamps(const Trajectory& estimate, const Trajectory& truth);

/// The poses of a perfect estimate at the same instants: the truth at the matched poses.
Trajectory truth_at_estimates(const Trajectory& estimate, const Trajectory& truth);

}  // namespace lidarena::evaluation
