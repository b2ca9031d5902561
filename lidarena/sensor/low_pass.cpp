// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/low_pass.hpp"

#include <cmath>
#include <numbers>

namespace lidarena::sensor {

LowPass::LowPass(double cutoff_hz, double rate_hz) {
  const double k = std::tan(std::numbers::pi * cutoff_hz / rate_hz);  // warped, exact at the cutoff
  const double scale = 1.0 / (1.0 + std::numbers::sqrt2 * k + k * k);
  gain_ = k * k * scale;
  feedback1_ = 2.0 * (k * k - 1.0) * scale;
  feedback2_ = (1.0 - std::numbers::sqrt2 * k + k * k) * scale;
}

/// Direct form II, transposed; numerator gain * (1, 2, 1).
LowPass::Vector6 LowPass::filtered(const Vector6& value) {
  if (!begun_) {  // the steady state of this value
    state2_ = (gain_ - feedback2_) * value;
    state1_ = (1.0 - gain_) * value;
    begun_ = true;
  }
  const Vector6 out = gain_ * value + state1_;
  state1_ = 2.0 * gain_ * value - feedback1_ * out + state2_;
  state2_ = gain_ * value - feedback2_ * out;
  return out;
}

}  // namespace lidarena::sensor
