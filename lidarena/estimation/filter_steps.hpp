// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "lidarena/estimation/iterated_update.hpp"

namespace lidarena::estimation {

/// One prediction of an inertial filter: the estimate at its begin, with all measurements until
/// then, and what it predicts for its end.
struct FilterStep {
  StateEstimate before, predicted;
  InertialState::Matrix transition = InertialState::Matrix::Identity();  ///< of the error
};

/// The states at the begin of each step, given the state `last` after the last one with all its
/// measurements (Rauch, Tung, Striebel, "Maximum Likelihood Estimates of Linear Dynamic Systems",
/// AIAA J. 1965), in the tangent spaces of the estimates.
std::vector<InertialState> smoothed(std::span<const FilterStep> steps, const InertialState& last);

}  // namespace lidarena::estimation
