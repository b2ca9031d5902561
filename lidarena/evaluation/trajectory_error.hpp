// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>

#include "lidarena/base/trajectory.hpp"

namespace lidarena {

/// Statistics of a set of non-negative errors; all zero with count 0 when the set is empty.
struct Summary {
  std::size_t count = 0;
  double rmse = 0.0, mean = 0.0, median = 0.0, p95 = 0.0, p99 = 0.0, max = 0.0;
};
Summary summarize(std::span<const double> errors);

/// Relative pose error over fixed lengths of reference path (paper eq. 1; definition `rpe_1m` of
/// docs/metrics.md).
struct RelativePoseError {
  double segment_m = 1.0;
  std::size_t used = 0;          ///< segments scored
  std::size_t total = 0;         ///< segments that the common time span has
  Summary translation_m;
  Summary rotation_rad;
};

/// How the estimate's frame was laid over the truth's.
enum class Gauge { kFirstPose, kSe3 };

struct AbsoluteTrajectoryError {
  Gauge gauge = Gauge::kSe3;
  Pose truth_from_estimate = Pose::Identity();
  Summary translation_m;
  Summary rotation_rad;
};

/// Share of the truth's time with an estimate, 0..1, and what the association found.
struct Association {
  std::size_t estimates = 0;   ///< poses of the estimate
  std::size_t matched = 0;     ///< of these, inside the truth's span
  double coverage = 0.0;
  double overlap_s = 0.0;
  double longest_gap_s = 0.0;  ///< between consecutive estimates
};

Association associate(const Trajectory& estimate, const Trajectory& truth);
RelativePoseError relative_pose_error(const Trajectory& estimate, const Trajectory& truth,
                                      double segment_m = 1.0, double step_m = 1.0);
AbsoluteTrajectoryError absolute_trajectory_error(const Trajectory& estimate,
                                                  const Trajectory& truth, Gauge gauge);

/// truth_from_estimate by the first common pose, or by Umeyama's least squares over all (no scale).
Pose align(const Trajectory& estimate, const Trajectory& truth, Gauge gauge);

}  // namespace lidarena
