// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace lidarena::sensor {

/// Butterworth low-pass of second order for six signals, by the bilinear transform (Oppenheim,
/// Schafer, "Discrete-Time Signal Processing", 3rd ed., 7.1). Gain at f: 1 / sqrt(1 + (f /
/// cutoff)^4); delay of slow signals: 0.225 / cutoff. The first value is taken as constant before.
class LowPass {
 public:
  using Vector6 = Eigen::Matrix<double, 6, 1>;

  LowPass(double cutoff_hz, double rate_hz);
  Vector6 filtered(const Vector6& value);

 private:
  double gain_, feedback1_, feedback2_;
  bool begun_ = false;
  Vector6 state1_ = Vector6::Zero(), state2_ = Vector6::Zero();
};

}  // namespace lidarena::sensor
