// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>

#include "lidarena/evaluation/trajectory/association.hpp"

namespace lidarena::evaluation {

/// Jitter of the estimated position while the body hovers.
struct HoverJitter {
  static constexpr double kSpeed_mps = 0.05;  ///< in a hover the truth is slower than this ...
  static constexpr double kMin_s = 1.0;       ///< ... for at least this long
  double seconds = 0.0;                       ///< total duration of the hovers
  std::size_t poses = 0;
  double rms_m = 0.0;  ///< of the position error about its mean over each hover
};

/// `pairs` of one flight, sorted by time; a time step longer than `gap_limit` ends a hover.
/// Independent of both world frames: within each hover the estimate is rotated into the truth's
/// frame by the hover's first pose.
HoverJitter hover_jitter(std::span<const PosePair> pairs, Time gap_limit);

}  // namespace lidarena::evaluation
