// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "lidarena/base/trajectory.hpp"

namespace lidarena::evaluation {

/// A constant clock error between two trajectories: a diagnostic, never applied.
struct TimeOffset {
  double late_s = 0.0;   ///< the estimate's stamps are this much later than the truth's
  double sigma_s = 0.0;  ///< formal uncertainty, from the misfit that remains
};

/// The offset within +-`range_s` for which the estimate's motions over about one second agree best
/// with the truth's (minimum mean square of the translation of eq. 1). Empty when the motion does
/// not determine it: no motions to compare, minimum at the end of the range, or sigma above 20 ms
/// (steady flight looks the same at any offset).
std::optional<TimeOffset> time_offset(const Trajectory& estimate, const Trajectory& truth,
                                      double range_s = 0.5);

}  // namespace lidarena::evaluation
