// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>

#include "lidarena/evaluation/association.hpp"

namespace lidarena {

/// How far the estimate wanders while the body stands still.
struct HoverJitter {
  static constexpr double kSpeed_mps = 0.05;  ///< slower than this is a hover ...
  static constexpr double kMin_s = 1.0;       ///< ... when it lasts
  double seconds = 0.0;                       ///< hovered in all
  std::size_t poses = 0;
  double rms_m = 0.0;  ///< of the position error about its mean over each hover
};

/// Over `pairs` of one flight, by time; steps longer than `bracket` end a hover. Depends on neither
/// world frame: each hover is compared in the truth's frame by its own first pose's rotation.
HoverJitter hover_jitter(std::span<const PosePair> pairs, Time bracket);

}  // namespace lidarena
