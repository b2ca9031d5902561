// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/summary.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lidarena/base/random.hpp"

namespace lidarena::results {
namespace {

TEST(Summary, NoErrorsGiveCountZeroAndNoNaN) {
  const Summary s = summarize({});
  EXPECT_EQ(s.count, 0U);
  EXPECT_EQ(s.rmse, 0.0);
  EXPECT_EQ(s.max, 0.0);
}

TEST(Summary, OneErrorIsAllItsStatistics) {
  const Summary s = summarize(std::vector{0.25});
  EXPECT_EQ(s.count, 1U);
  for (const double value : {s.rmse, s.mean, s.median, s.p95, s.p99, s.max}) {
    EXPECT_DOUBLE_EQ(value, 0.25);
  }
}

TEST(Summary, AnEvenCountHasItsMedianHalfwayBetweenTheMiddleTwo) {
  const Summary s = summarize(std::vector{4.0, 1.0, 3.0, 2.0});
  EXPECT_DOUBLE_EQ(s.median, 2.5);
  EXPECT_DOUBLE_EQ(s.mean, 2.5);
  EXPECT_DOUBLE_EQ(s.rmse, std::sqrt(30.0 / 4.0));
  EXPECT_DOUBLE_EQ(s.max, 4.0);
}

TEST(Summary, QuantilesAreThoseOfTheSortedValues) {
  SequentialRandom random(7);
  std::vector<double> values(1001);
  for (double& value : values) value = random.uniform();
  const Summary s = summarize(values);
  std::sort(values.begin(), values.end());
  EXPECT_EQ(s.median, values[500]);
  EXPECT_EQ(s.p95, values[950]);
  EXPECT_EQ(s.p99, values[990]);
  EXPECT_NEAR(quantile(values, 0.1234), values[123] + 0.4 * (values[124] - values[123]), 1e-12);
}

TEST(FitLine, FindsTheLineOfNoisyPointsAndHowMuchItExplains) {
  std::vector<double> x, y, odd;
  for (int i = 0; i < 100; ++i) {
    x.push_back(0.1 * i);
    y.push_back(3.0 - 2.0 * x.back());
    odd.push_back(i % 2 == 0 ? 1.0 : -1.0);
  }
  const Line line = fit_line(x, y);
  EXPECT_NEAR(line.slope, -2.0, 1e-12);
  EXPECT_NEAR(line.intercept, 3.0, 1e-12);
  EXPECT_NEAR(line.r_squared, 1.0, 1e-12);
  EXPECT_LT(fit_line(x, odd).r_squared, 1e-3);
  EXPECT_EQ(fit_line(std::vector{1.0, 1.0, 1.0}, std::vector{1.0, 2.0, 3.0}).slope, 0.0);
  EXPECT_EQ(fit_line(std::vector{1.0, 2.0}, std::vector{1.0, 2.0}).slope, 0.0);
}

}  // namespace
}  // namespace lidarena::results
