// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/map/scored_returns.hpp"

#include <gtest/gtest.h>

#include <set>

#include "lidarena/base/point_truth.hpp"
#include "lidarena/base/scan.hpp"

namespace lidarena::evaluation {
namespace {

TEST(ScoredReturns, ASparseScanStaysAsItIs) {
  std::vector<int> points(kScoredReturns, 7);
  keep_scored(points, kScoredReturns);
  EXPECT_EQ(points.size(), kScoredReturns);
  EXPECT_EQ(scoring_stride(0, kScoredReturns), 1U);
}

TEST(ScoredReturns, NeverMoreThanTheLimitAndNeverFarFewer) {
  for (std::size_t n = kScoredReturns + 1; n < 50 * kScoredReturns; n += 997) {
    std::vector<int> points(n);
    keep_scored(points, kScoredReturns);
    EXPECT_LE(points.size(), kScoredReturns) << n;
    EXPECT_GE(points.size(), kScoredReturns / 3) << n;  // of 20,001 every third: strides are odd
  }
}

TEST(ScoredReturns, ALongRecordingGivesFewerOfEachScan) {
  EXPECT_EQ(scored_returns(0), 20'000U);    // unknown number of scans
  EXPECT_EQ(scored_returns(200), 20'000U);  // 20 s at 10 Hz
  EXPECT_EQ(scored_returns(3000), 3'333U);
  EXPECT_EQ(scored_returns(100'000'000), 1U);
}

TEST(ScoredReturns, EveryRowOfASpinningSensorIsLookedAt) {
  for (const std::size_t columns : {512U, 1024U, 2048U}) {
    std::vector<std::size_t> points(columns * 128);
    for (std::size_t i = 0; i < points.size(); ++i) points[i] = i % 128;  // column after column
    keep_scored(points, kScoredReturns);
    EXPECT_EQ(std::set<std::size_t>(points.begin(), points.end()).size(), 128U) << columns;
  }
}

TEST(ScoredReturns, AScanAndItsTruthKeepTheSameReturnsInOrderAndTwiceIsAsOnce) {
  constexpr std::size_t kPoints = 131'072;
  std::vector<Point> points(kPoints);
  std::vector<PointTruth> hits(kPoints);
  for (std::size_t i = 0; i < kPoints; ++i) {
    points[i].dt_ns = static_cast<std::int32_t>(i);
    hits[i].triangle = static_cast<std::uint32_t>(i);
  }
  for (int times = 0; times < 2; ++times) {
    keep_scored(points, kScoredReturns);
    keep_scored(hits, kScoredReturns);
  }
  ASSERT_EQ(points.size(), hits.size());
  EXPECT_EQ(points.size(), 18'725U);  // every 7th
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(points[i].dt_ns, static_cast<std::int32_t>(7 * i));
    EXPECT_EQ(hits[i].triangle, 7 * i);
  }
}

}  // namespace
}  // namespace lidarena::evaluation
