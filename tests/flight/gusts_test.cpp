// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/gusts.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace lidarena::flight {
namespace {

using Eigen::Vector3d;

GustConfig gusts_of_seed(std::uint64_t seed = 1) {
  return {.wind = {1.0, -0.5, 0.0}, .gust_speed = 0.6, .correlation_time_s = 0.8, .seed = seed};
}

TEST(Gusts, AreOffByDefaultAndBeforeTheFlight) {
  EXPECT_TRUE(Gusts(GustConfig{}).still());
  EXPECT_EQ(Gusts(GustConfig{}).at(5.0).norm(), 0.0);
  EXPECT_EQ(Gusts(gusts_of_seed()).at(0.0).norm(), 0.0);
  EXPECT_GT(Gusts(gusts_of_seed()).at(5.0).norm(), 0.0);
}

TEST(Gusts, HaveTheMeanTheDeviationAndTheCorrelationOfTheirSpectrum) {
  // each seed is one sample of frequencies and phases: average over seeds and a long time
  constexpr int kSeeds = 20;
  constexpr double kSpan = 400.0, kStep = 0.05;
  const double lag = 0.8;
  Vector3d mean = Vector3d::Zero();
  double variance = 0.0, product = 0.0;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Gusts gusts(gusts_of_seed(seed));
    for (double t = 2.0; t < kSpan; t += kStep, ++count) {
      const Vector3d now = gusts.at(t);
      mean += now;
      const Vector3d deviation = now - Vector3d(1.0, -0.5, 0.0);
      variance += deviation.squaredNorm() / 3.0;
      product += deviation.dot(gusts.at(t + lag) - Vector3d(1.0, -0.5, 0.0)) / 3.0;
    }
  }
  mean /= count;
  // 20 * 400 s / (2 * 0.8 s) = 5000 independent samples: 0.6 / sqrt(5000) = 0.008, four sigma
  EXPECT_NEAR((mean - Vector3d(1.0, -0.5, 0.0)).norm(), 0.0, 0.035);
  // the mean square of the sines is the variance, except for slow ones over a finite time span
  EXPECT_NEAR(variance / count, 0.36, 0.05 * 0.36);
  // a first-order spectrum has the correlation exp(-lag / T); the cutoff at 30 rad/s removes 2.7 %
  EXPECT_NEAR(product / variance, std::exp(-1.0), 0.06);
}

TEST(Gusts, DependOnTheSeedAlone) {
  const Gusts a(gusts_of_seed(3)), b(gusts_of_seed(3)), other(gusts_of_seed(4));
  for (double t = 0.1; t < 20.0; t += 0.7) {
    EXPECT_EQ(a.at(t), b.at(t));
    EXPECT_NE(a.at(t), other.at(t));
  }
}

}  // namespace
}  // namespace lidarena::flight
