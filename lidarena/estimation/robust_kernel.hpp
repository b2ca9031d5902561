// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

/// Weights of iteratively re-weighted least squares: w(r) = (d rho / d r) / r for a loss rho that
/// behaves as r^2 / 2 near zero, so w(0) = 1. All take the SQUARED residual and a scale in the unit
/// of the residual. Losses as listed by Zhang, "Parameter estimation techniques" (1997), table 1.
namespace lidarena::robust {

/// rho = r^2 / 2 up to `scale`, linear beyond.
inline double huber(double squared_residual, double scale) {
  return squared_residual <= scale * scale ? 1.0 : scale / std::sqrt(squared_residual);
}

/// rho = scale^2 / 2 log(1 + r^2 / scale^2).
inline double cauchy(double squared_residual, double scale) {
  return 1.0 / (1.0 + squared_residual / (scale * scale));
}

/// rho = r^2 / 2 / (1 + r^2 / scale^2).
inline double geman_mcclure(double squared_residual, double scale) {
  const double ratio = 1.0 / (1.0 + squared_residual / (scale * scale));
  return ratio * ratio;
}

/// rho = scale^2 / 6 (1 - (1 - r^2 / scale^2)^3), constant beyond `scale`.
inline double tukey(double squared_residual, double scale) {
  const double remainder = 1.0 - squared_residual / (scale * scale);
  return remainder > 0.0 ? remainder * remainder : 0.0;
}

/// rho = r^2 / 2, constant beyond `scale`.
inline double truncated(double squared_residual, double scale) {
  return squared_residual <= scale * scale ? 1.0 : 0.0;
}

}  // namespace lidarena::robust
