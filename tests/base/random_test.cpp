// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/base/random.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace lidarena {
namespace {

// Known answers published with the Random123 library for philox4x32-10.
TEST(Random, PhiloxGivesThePublishedKnownAnswers) {
  using Words = std::array<std::uint32_t, 4>;
  EXPECT_EQ(philox({0, 0, 0, 0}, {0, 0}), (Words{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  EXPECT_EQ(philox({0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}, {0xffffffff, 0xffffffff}),
            (Words{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (Words{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(Random, NormalsHaveTheMomentsOfTheNormalDistribution) {
  const CounterRandom random(3, stream_of("moments"));
  constexpr int n = 200000;  // 400,000 values: mean +-0.0016, variance +-0.0022, kurtosis +-0.0077
  double m1 = 0;
  double m2 = 0;
  double m4 = 0;
  double cross = 0;
  for (int i = 0; i < n; ++i) {
    const auto z = random.normals(static_cast<std::uint64_t>(i));
    for (const double x : z) {
      m1 += x / (2 * n);
      m2 += x * x / (2 * n);
      m4 += x * x * x * x / (2 * n);
    }
    cross += z[0] * z[1] / n;
  }
  EXPECT_NEAR(m1, 0.0, 5 * 0.0016);
  EXPECT_NEAR(m2, 1.0, 5 * 0.0022);
  EXPECT_NEAR(m4, 3.0, 5 * 0.0155);  // sqrt((105 - 9) / 400000)
  EXPECT_NEAR(cross, 0.0, 5 * 0.0022);
}

TEST(Random, ValuesDependOnSeedStreamIndexAndDrawAlone) {
  const CounterRandom a(1, 5);
  const CounterRandom b(1, 5);
  EXPECT_EQ(a.uniform(99, 2), b.uniform(99, 2));
  EXPECT_NE(a.uniform(99, 2), a.uniform(99, 3));
  EXPECT_NE(a.uniform(99, 2), a.uniform(98, 2));
  EXPECT_NE(a.uniform(99, 2), CounterRandom(1, 6).uniform(99, 2));
  EXPECT_NE(a.uniform(99, 2), CounterRandom(2, 5).uniform(99, 2));
  EXPECT_NE(a.uniform(99, 2), CounterRandom(1ULL | (1ULL << 40U), 5).uniform(99, 2));
}

}  // namespace
}  // namespace lidarena
