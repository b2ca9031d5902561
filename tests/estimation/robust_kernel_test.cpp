// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/robust_kernel.hpp"

#include <ceres/loss_function.h>
#include <gtest/gtest.h>

#include <memory>

namespace lidarena::estimation {
namespace {

constexpr double kScale = 0.7;
constexpr double kResiduals[] = {0.01, 0.1, 0.3, 0.69, 0.71, 1.0, 3.0, 20.0};

template <class Check>
void for_each_kernel(Check&& check) {
  for (const auto& [name, kernel] : enum_names(RobustKernel{})) {
    SCOPED_TRACE(name);
    check(kernel);
  }
}

TEST(RobustKernel, WeightIsTheSlopeOfTheCostOverTheResidual) {
  for_each_kernel([](RobustKernel kernel) {
    for (const double r : kResiduals) {
      const double h = 1e-6;
      const auto cost = [&](double x) { return robust_cost(kernel, x * x, kScale); };
      const double slope = (cost(r + h) - cost(r - h)) / (2 * h);
      // central difference: h^2 times third derivatives of order 1 / scale, and 1e-16 cost / h
      EXPECT_NEAR(robust_weight(kernel, r * r, kScale), slope / r, 1e-7) << "at " << r;
    }
  });
}

TEST(RobustKernel, SmallResidualsCountInFullAndLargerOnesNeverMore) {
  for_each_kernel([](RobustKernel kernel) {
    EXPECT_EQ(robust_weight(kernel, 0.0, kScale), 1.0);
    double previous = 1.0;
    for (double r = 0.0; r < 3.0; r += 0.01) {
      const double weight = robust_weight(kernel, r * r, kScale);
      EXPECT_LE(weight, previous) << "at " << r;
      EXPECT_GE(weight, 0.0);
      previous = weight;
    }
  });
}

TEST(RobustKernel, CeresHasTheSameCostsAndWeights) {
  for_each_kernel([](RobustKernel kernel) {
    const std::unique_ptr<ceres::LossFunction> loss(make_ceres_loss(kernel, kScale));
    if (kernel == RobustKernel::kNone) {
      EXPECT_EQ(loss, nullptr);
      return;
    }
    for (const double r : kResiduals) {
      double rho[3];  // of the squared residual: twice the cost, and its derivatives
      loss->Evaluate(r * r, rho);
      EXPECT_NEAR(0.5 * rho[0], robust_cost(kernel, r * r, kScale), 1e-14 * (1.0 + r * r));
      EXPECT_NEAR(rho[1], robust_weight(kernel, r * r, kScale), 1e-14);
    }
  });
}

}  // namespace
}  // namespace lidarena::estimation
