// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "lidarena/base/trajectory.hpp"

namespace lidarena {

/// What the comparison of two trajectories rests on; printed before any error.
struct Association {
  std::size_t estimates = 0;  ///< poses of the estimate
  std::size_t truths = 0;     ///< poses of the truth
  std::size_t matched = 0;    ///< estimates with a truth at their instant, see matched_poses()
  /// Share of the truth's time, 0..1, between two estimates not farther apart than max_bracket().
  double coverage = 0.0;
  double overlap_s = 0.0;         ///< length of the common time span
  double longest_gap_s = 0.0;     ///< between consecutive estimates
  double estimate_rate_hz = 0.0;  ///< 1 / median period; 0 with fewer than two poses
  double truth_rate_hz = 0.0;
};
Association associate(const Trajectory& estimate, const Trajectory& truth);

/// Median time between consecutive poses; zero with fewer than two.
Time median_period(const Trajectory& trajectory);

/// Two poses farther apart than this (1.5 median periods) have a gap between them, and nothing is
/// interpolated across a gap.
Time max_bracket(const Trajectory& trajectory);

/// Trajectory::at, but empty inside gaps longer than `bracket`.
std::optional<Pose> pose_between(const Trajectory& trajectory, Time t, Time bracket);

/// Both poses of one instant.
struct PosePair {
  Time stamp{0};
  Pose truth = Pose::Identity();
  Pose estimate = Pose::Identity();
};

/// Each estimate with the truth interpolated at its instant; estimates outside the truth's span or
/// in one of its gaps are left out.
std::vector<PosePair> matched_poses(const Trajectory& estimate, const Trajectory& truth);

}  // namespace lidarena
