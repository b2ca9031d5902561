// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/robust_kernel.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace lidarena::robust {
namespace {

constexpr double kScale = 0.7;
constexpr double kScale2 = kScale * kScale;

struct Kernel {
  const char* name;
  double (*weight)(double, double);
  std::function<double(double)> loss;  // rho(r)
};

const Kernel kKernels[] = {
    {"huber", huber, [](double r) { return r <= kScale ? r * r / 2 : kScale * (r - kScale / 2); }},
    {"cauchy", cauchy, [](double r) { return kScale2 / 2 * std::log(1 + r * r / kScale2); }},
    {"geman_mcclure", geman_mcclure, [](double r) { return r * r / 2 / (1 + r * r / kScale2); }},
    {"tukey", tukey,
     [](double r) {
       return r > kScale ? kScale2 / 6 : kScale2 / 6 * (1 - std::pow(1 - r * r / kScale2, 3));
     }},
    {"truncated", truncated,
     [](double r) { return std::min(r, kScale) * std::min(r, kScale) / 2; }},
};

TEST(RobustKernel, WeightIsTheSlopeOfTheLossOverTheResidual) {
  for (const Kernel& kernel : kKernels) {
    for (const double r : {0.01, 0.1, 0.3, 0.69, 0.71, 1.0, 3.0, 20.0}) {
      const double h = 1e-6;
      const double slope = (kernel.loss(r + h) - kernel.loss(r - h)) / (2 * h);
      // central difference: h^2 times third derivatives of order 1 / scale, and 1e-16 loss / h
      EXPECT_NEAR(kernel.weight(r * r, kScale), slope / r, 1e-7) << kernel.name << " at " << r;
    }
  }
}

TEST(RobustKernel, SmallResidualsCountInFullAndLargerOnesNeverMore) {
  for (const Kernel& kernel : kKernels) {
    EXPECT_EQ(kernel.weight(0.0, kScale), 1.0) << kernel.name;
    double previous = 1.0;
    for (double r = 0.0; r < 3.0; r += 0.01) {
      const double weight = kernel.weight(r * r, kScale);
      EXPECT_LE(weight, previous) << kernel.name << " at " << r;
      EXPECT_GE(weight, 0.0);
      previous = weight;
    }
  }
}

}  // namespace
}  // namespace lidarena::robust
