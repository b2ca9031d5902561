// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/scenes/gradient_noise.hpp"

#include <gtest/gtest.h>

#include "tests/world/shapes.hpp"

namespace lidarena::scenes {
namespace {

using world::testing::random_point;

TEST(GradientNoise, VanishesOnTheLatticeAndStaysBounded) {
  const GradientNoise noise(3);
  SequentialRandom random(1);
  for (int i = 0; i < 100000; ++i) {
    const Eigen::Vector3d p = random_point(random, 1000);
    EXPECT_LT(std::abs(noise(p)), 1.04);
    EXPECT_EQ(noise(p.array().round()), 0.0);
  }
}

TEST(GradientNoise, HasMeanZeroAndTheSameVarianceEverywhere) {
  // Samples farther apart than a lattice step are independent: the mean of n samples has the
  // standard deviation sigma / sqrt(n).
  constexpr int kCount = 200000;
  for (const double center : {0.0, 5000.0}) {
    const GradientNoise noise(11);
    SequentialRandom random(2);
    double sum = 0;
    double squares = 0;
    for (int i = 0; i < kCount; ++i) {
      const double value = noise(random_point(random, 400) + Eigen::Vector3d::Constant(center));
      sum += value;
      squares += value * value;
    }
    const double sigma = std::sqrt(squares / kCount);
    EXPECT_NEAR(sum / kCount, 0, 4 * sigma / std::sqrt(kCount));
    EXPECT_NEAR(sigma, 0.27, 0.02);
  }
}

TEST(GradientNoise, IsSmoothAcrossCells) {
  const GradientNoise noise(5);
  SequentialRandom random(3);
  constexpr double kH = 1e-5;
  for (int i = 0; i < 1000; ++i) {
    Eigen::Vector3d p = random_point(random, 10);
    p.x() = std::round(p.x());  // on a face of a cell: the slopes from both sides must agree
    const Eigen::Vector3d h = kH * Eigen::Vector3d::UnitX();
    const double left = (noise(p) - noise(p - h)) / kH;
    const double right = (noise(p + h) - noise(p)) / kH;
    EXPECT_NEAR(left, right, 20 * kH);  // curvature stays below 20
  }
}

TEST(GradientNoise, DependsOnTheSeedAlone) {
  SequentialRandom random(4);
  int equal = 0;
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d p = random_point(random, 100);
    EXPECT_EQ(GradientNoise(8)(p), GradientNoise(8)(p));
    equal += GradientNoise(8)(p) == GradientNoise(9)(p) ? 1 : 0;
  }
  EXPECT_EQ(equal, 0);
}

}  // namespace
}  // namespace lidarena::scenes
