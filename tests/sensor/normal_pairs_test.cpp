// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/normal_pairs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "lidarena/sensor/signal_model.hpp"

namespace lidarena::sensor {
namespace {

constexpr std::size_t kPairs = 400'000;

TEST(NormalPairs, AreThoseOfTheCounterBasedNumbers) {
  const CounterRandom random(7, 3);
  NormalPairs pairs;
  pairs.draw(random, 11, kPairs, 2);
  for (std::size_t i = 0; i < kPairs; ++i) {
    const auto [first, second] = random.normals(11 + i, 2);
    // What single precision leaves of the angle (up to 2 pi) and of the logarithm of u, which is
    // up to 2^-24 off 1 where r is small.
    const double r = std::hypot(first, second);
    const double bound = 1e-6 * std::max(r, 1.0) + 0x1.0p-24 / std::max(r, 0x1.0p-12);
    ASSERT_NEAR(static_cast<double>(pairs.first(i)), first, bound) << i;
    ASSERT_NEAR(static_cast<double>(pairs.second(i)), second, bound) << i;
  }
}

TEST(NormalPairs, AreStandardNormal) {
  NormalPairs pairs;
  pairs.draw(CounterRandom(7, 3), 11, kPairs, 0);
  std::vector<double> values;
  for (std::size_t i = 0; i < kPairs; ++i) {
    values.push_back(static_cast<double>(pairs.first(i)));
    values.push_back(static_cast<double>(pairs.second(i)));
  }
  std::ranges::sort(values);
  const auto count = static_cast<double>(values.size());
  // Kolmogorov and Smirnov: the largest distance of the two distributions exceeds
  // 1.95 / sqrt(n) in one of 1000 cases.
  double distance = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double share = (static_cast<double>(i) + 0.5) / count;
    distance = std::max(distance, std::abs(normal_cdf(values[i]) - share));
  }
  EXPECT_LT(distance, 1.95 / std::sqrt(count));
  // Of 800,000 values 51 are expected beyond 4 sigma.
  const auto beyond =
      std::ranges::count_if(values, [](double value) { return std::abs(value) > 4.0; });
  EXPECT_GT(beyond, 25);
  EXPECT_LT(beyond, 85);
}

TEST(NormalPairs, DependOnTheirIndexAlone) {
  const CounterRandom random(5, 1);
  NormalPairs all, part;
  all.draw(random, 0, 1000, 0);
  for (const std::size_t count : {1, 2, 3, 5, 15, 16, 17, 100}) {
    part.draw(random, 40, count, 0);
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_EQ(part.first(i), all.first(40 + i)) << count << " " << i;
      EXPECT_EQ(part.second(i), all.second(40 + i)) << count << " " << i;
    }
  }
}

}  // namespace
}  // namespace lidarena::sensor
