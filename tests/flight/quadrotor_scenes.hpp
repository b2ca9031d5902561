// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "lidarena/flight/quadrotor.hpp"

namespace lidarena::flight::test_scenes {

/// The state after `seconds`, integrated with steps of `h` (s).
template <class Derivative>
QuadrotorState integrated(QuadrotorState state, double seconds, double h,
                          const Derivative& derivative) {
  const auto steps = std::lround(seconds / h);
  for (long k = 0; k < steps; ++k) {
    state = runge_kutta(state, static_cast<double>(k) * h, h, derivative);
  }
  return state;
}

}  // namespace lidarena::flight::test_scenes
