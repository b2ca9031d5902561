// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/map/scored_returns.hpp"

#include <gtest/gtest.h>

#include <set>

#include "tests/evaluation/listed_sources.hpp"

namespace lidarena::evaluation {
namespace {

Scan scan_of(std::size_t points) {
  Scan scan;
  for (std::size_t i = 0; i < points; ++i) {
    scan.points.push_back(
        {{static_cast<float>(i), 0, 0}, 0.0F, static_cast<std::int32_t>(i), 0, 0});
  }
  return scan;
}

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
  auto events = std::make_unique<listed::Events>();
  events->events.push_back({"os0", ImuSample{}});
  events->events.push_back({"os0", scan_of(kPoints)});
  auto truths = std::make_unique<listed::Truths>();
  dataset::ScanTruth truth;
  for (std::size_t i = 0; i < kPoints; ++i) {
    dataset::PointTruth& point = truth.points.emplace_back();
    point.triangle = static_cast<std::uint32_t>(i);
  }
  truths->scans.push_back(truth);

  constexpr std::size_t kMaxReturns = 20'000;
  ScoredEvents scored(std::make_unique<ScoredEvents>(std::move(events), kMaxReturns), kMaxReturns);
  ScoredTruth hits(std::make_unique<ScoredTruth>(std::move(truths), kMaxReturns), kMaxReturns);
  EXPECT_TRUE(std::holds_alternative<ImuSample>(scored.next()->data));
  const Scan scan = std::get<Scan>(scored.next()->data);
  const dataset::ScanTruth hit = *hits.next();
  ASSERT_EQ(scan.points.size(), hit.points.size());
  EXPECT_EQ(scan.points.size(), 18'725U);  // every 7th
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    EXPECT_EQ(scan.points[i].dt_ns, static_cast<std::int32_t>(7 * i));
    EXPECT_EQ(hit.points[i].triangle, 7 * i);
  }
  EXPECT_FALSE(scored.next());
  EXPECT_FALSE(hits.next());
}

}  // namespace
}  // namespace lidarena::evaluation
