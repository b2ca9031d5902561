// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/base/parallel.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>

#include "lidarena/base/random.hpp"

namespace lidarena {
namespace {

TEST(Parallel, SumsAreTheSameBitsOnAnyNumberOfThreads) {
  const CounterRandom random(11);
  const auto sum = [&](int threads) {
    return Parallel(threads).reduce(
        100001, 256, 0.0F,
        [&](std::size_t begin, std::size_t end) {
          float s = 0.0F;
          for (std::size_t i = begin; i < end; ++i) s += static_cast<float>(random.uniform(i));
          return s;
        },
        [](float& a, const float& b) { a += b; });
  };
  const float one = sum(1);
  EXPECT_NEAR(one, 50000.0F, 500.0F);
  for (const int threads : {2, 3, 5}) EXPECT_EQ(one, sum(threads)) << threads;
}

TEST(Parallel, EveryIndexIsVisitedOnce) {
  std::vector<std::atomic<int>> visits(1003);
  Parallel(4).for_each(visits.size(), 10, [&](std::size_t i) { ++visits[i]; });
  for (const auto& v : visits) EXPECT_EQ(v, 1);
  Parallel(4).for_each(0, 10, [&](std::size_t) { FAIL() << "nothing to visit"; });
}

TEST(Parallel, AnExceptionInABlockReachesTheCaller) {
  EXPECT_THROW(Parallel(2).for_each(100, 1,
                                    [](std::size_t i) {
                                      if (i == 57) throw std::runtime_error("57");
                                    }),
               std::runtime_error);
}

TEST(Parallel, TwoInstancesKeepTheirOwnLimit) {
  const Parallel one(1);
  const Parallel three(3);
  EXPECT_EQ(one.threads(), 1);
  EXPECT_EQ(three.threads(), 3);
  EXPECT_GE(Parallel().threads(), 1);
}

}  // namespace
}  // namespace lidarena
