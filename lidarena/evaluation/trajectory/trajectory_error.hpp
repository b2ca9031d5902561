// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "lidarena/base/trajectory.hpp"
#include "lidarena/evaluation/trajectory/alignment.hpp"
#include "lidarena/evaluation/trajectory/association.hpp"
#include "lidarena/results/trajectory_metrics.hpp"

namespace lidarena::evaluation {

using results::kRpeLengths_m;
using results::Summary;

/// Relative error of one piece of the flight.
struct SegmentError {
  Time begin{0};
  Time end{0};
  double translation_m = 0.0;
  double rotation_rad = 0.0;
};

/// Relative pose error over pieces of equal path length or equal duration (paper eq. 1; definitions
/// `rpe_*` of docs/metrics.md).
struct RelativePoseError {
  double segment_m = 0.0;  ///< path length of a piece on the truth, or
  double segment_s = 0.0;  ///< its duration; the other is zero
  double step = 0.0;       ///< between starts of pieces, in the same unit
  bool at_poses = false;   ///< pieces run from pose to pose of the estimate
  std::size_t used = 0;    ///< pieces scored
  std::size_t total = 0;   ///< pieces in the common time span
  Summary translation_m;
  Summary rotation_rad;
  std::vector<SegmentError> segments;  ///< the scored ones, sorted by time
};

/// Error per `segment_m` of path. Arc length is measured on the truth within the common time span;
/// ends are interpolated in both trajectories; a piece with an end in a gap is dropped. Throws
/// InputError when a length is not positive.
RelativePoseError relative_pose_error(const Trajectory& estimate, const Trajectory& truth,
                                      double segment_m = 1.0, double step_m = 1.0);

/// The same with each end moved to the nearest pose of the estimate, so that nothing of the
/// estimate is interpolated; errors are scaled to `segment_m` of true path between these poses. A
/// piece whose ends fall on the same pose is dropped. For a perfect estimate only rounding remains.
RelativePoseError relative_pose_error_at_poses(const Trajectory& estimate, const Trajectory& truth,
                                               double segment_m = 1.0);

/// relative_pose_error_at_poses() at the constant time offset for which its translation is least.
struct RpeAtBestOffset {
  double late_s = 0.0;   ///< the estimate's stamps are this much later than the truth's
  double range_s = 0.0;  ///< of the search, to both sides
  RelativePoseError rpe;
};

/// The offset is searched within +-`range_s`, to 0.1 ms, for the least RMSE of the translation.
/// Empty without pieces.
std::optional<RpeAtBestOffset> relative_pose_error_at_best_offset(const Trajectory& estimate,
                                                                  const Trajectory& truth,
                                                                  double range_s = 0.1);

/// Error per `segment_s` of time; also defined while the body hovers.
RelativePoseError relative_pose_error_over_time(const Trajectory& estimate, const Trajectory& truth,
                                                double segment_s = 1.0, double step_s = 1.0);

/// Errors of one instant after alignment.
struct PoseError {
  Time stamp{0};
  double translation_m = 0.0;
  double rotation_rad = 0.0;
};

struct AbsoluteTrajectoryError {
  Alignment alignment;
  Summary translation_m;  ///< count 0 when the alignment is refused
  Summary rotation_rad;
  std::vector<PoseError> poses;
};

/// Absolute error at each estimate's instant, truth interpolated there (definition `ate`).
AbsoluteTrajectoryError absolute_trajectory_error(const Trajectory& estimate,
                                                  const Trajectory& truth, AlignmentKind kind);

}  // namespace lidarena::evaluation
