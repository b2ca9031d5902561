// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/filter_steps.hpp"

#include <Eigen/Cholesky>

namespace lidarena::estimation {

std::vector<InertialState> smoothed(std::span<const FilterStep> steps, const InertialState& last) {
  std::vector<InertialState> states(steps.size());
  InertialState after = last;
  for (std::size_t i = steps.size(); i-- > 0;) {
    const auto& [before, predicted, transition] = steps[i];
    const InertialState::Matrix gain =
        predicted.covariance.ldlt().solve(transition * before.covariance).transpose();
    after = plus(before.state, gain * minus(after, predicted.state));
    states[i] = after;
  }
  return states;
}

}  // namespace lidarena::estimation
