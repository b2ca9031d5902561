// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>

#include "lidarena/evaluation/trajectory/association.hpp"
#include "lidarena/results/trajectory_metrics.hpp"

namespace lidarena::evaluation {

using results::HoverJitter;

/// `pairs` of one flight, sorted by time; a time step longer than `gap_limit` ends a hover.
/// Independent of both world frames: within each hover the estimate is rotated into the truth's
/// frame by the hover's first pose.
HoverJitter hover_jitter(std::span<const PosePair> pairs, Time gap_limit);

}  // namespace lidarena::evaluation
