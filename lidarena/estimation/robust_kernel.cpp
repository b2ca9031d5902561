// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/robust_kernel.hpp"

#include <ceres/loss_function.h>

#include <algorithm>
#include <cmath>

namespace lidarena::estimation {

double robust_cost(RobustKernel kernel, double squared_residual, double scale) {
  const double ratio = squared_residual / (scale * scale);
  switch (kernel) {
    case RobustKernel::kNone:
      break;
    case RobustKernel::kHuber:
      return ratio <= 1.0 ? 0.5 * squared_residual : scale * scale * (std::sqrt(ratio) - 0.5);
    case RobustKernel::kCauchy:
      return 0.5 * scale * scale * std::log1p(ratio);
    case RobustKernel::kTukey:
      return scale * scale / 6.0 * (1.0 - std::pow(std::max(0.0, 1.0 - ratio), 3.0));
  }
  return 0.5 * squared_residual;
}

double robust_weight(RobustKernel kernel, double squared_residual, double scale) {
  const double squared_scale = scale * scale;
  switch (kernel) {
    case RobustKernel::kNone:
      break;
    case RobustKernel::kHuber:
      return squared_residual <= squared_scale ? 1.0 : scale / std::sqrt(squared_residual);
    case RobustKernel::kCauchy:
      return 1.0 / (1.0 + squared_residual / squared_scale);
    case RobustKernel::kTukey: {
      const double remainder = 1.0 - squared_residual / squared_scale;
      return remainder > 0.0 ? remainder * remainder : 0.0;
    }
  }
  return 1.0;
}

double geman_mcclure_weight(double residual, double scale) {
  const double root = scale * scale / (scale * scale + residual * residual);
  return root * root;
}

ceres::LossFunction* make_ceres_loss(RobustKernel kernel, double scale) {
  switch (kernel) {
    case RobustKernel::kNone:
      break;
    case RobustKernel::kHuber:
      return new ceres::HuberLoss(scale);
    case RobustKernel::kCauchy:
      return new ceres::CauchyLoss(scale);
    case RobustKernel::kTukey:
      return new ceres::TukeyLoss(scale);
  }
  return nullptr;
}

}  // namespace lidarena::estimation
