// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <utility>

#include "lidarena/base/config.hpp"

namespace ceres {
class LossFunction;
}

namespace lidarena::estimation {

/// Robust kernels: costs rho(r) that grow slower than r^2 / 2 beyond a scale. All are r^2 / 2 for
/// small residuals r; the scale is in the residual's unit.
enum class RobustKernel {
  kNone,    ///< r^2 / 2
  kHuber,   ///< linear beyond `scale`
  kCauchy,  ///< scale^2 / 2 log(1 + r^2 / scale^2)
  kTukey,   ///< scale^2 / 6 (1 - (1 - r^2 / scale^2)^3), constant beyond `scale`
};

constexpr auto enum_names(RobustKernel) {
  return std::array{
      std::pair{"none", RobustKernel::kNone}, std::pair{"huber", RobustKernel::kHuber},
      std::pair{"cauchy", RobustKernel::kCauchy}, std::pair{"tukey", RobustKernel::kTukey}};
}

/// rho(r).
double robust_cost(RobustKernel kernel, double squared_residual, double scale);
/// rho'(r) / r: weight of the residual in iteratively re-weighted least squares.
double robust_weight(RobustKernel kernel, double squared_residual, double scale);
/// Weight of the kernel of S. Geman, D. McClure, "Statistical Methods for Tomographic Image
/// Reconstruction", 1987: r^2 / 2 for small residuals r, constant for large ones; a quarter at r =
/// `scale`.
double geman_mcclure_weight(double residual, double scale);
/// The same kernel for Ceres, owned by the caller; null for kNone.
ceres::LossFunction* make_ceres_loss(RobustKernel kernel, double scale);

}  // namespace lidarena::estimation
