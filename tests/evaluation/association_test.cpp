// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/trajectory/association.hpp"

#include <gtest/gtest.h>

#include "flights.hpp"

namespace lidarena::evaluation {
namespace {

using namespace std::chrono_literals;
using flights::sample;
using flights::tour;
using flights::with_gap;

TEST(Association, ACompleteEstimateCoversAllAndMatchesEveryPose) {
  const Association found = associate(sample(tour, 100ms, 20s), sample(tour, 5ms, 20s));
  EXPECT_EQ(found.estimates, 201U);
  EXPECT_EQ(found.truths, 4001U);
  EXPECT_EQ(found.matched, 201U);
  EXPECT_DOUBLE_EQ(found.coverage, 1.0);
  EXPECT_DOUBLE_EQ(found.overlap_s, 20.0);
  EXPECT_DOUBLE_EQ(found.longest_gap_s, 0.1);
  EXPECT_DOUBLE_EQ(found.estimate_rate_hz, 10.0);
  EXPECT_DOUBLE_EQ(found.truth_rate_hz, 200.0);
}

TEST(Association, CoverageIsTheShareOfTruthTimeBetweenNeighboringEstimates) {
  // 2..17 s of 0..20 s with a gap of 3 s: 12 of 20 s
  const Trajectory cut = with_gap(with_gap(sample(tour, 100ms, 20s), -1s, 2s), 17s, 30s);
  const Association found = associate(with_gap(cut, 8s, 11s), sample(tour, 5ms, 20s));
  EXPECT_NEAR(found.coverage, 0.6, 1e-12);
  EXPECT_NEAR(found.overlap_s, 15.0, 1e-12);
  EXPECT_NEAR(found.longest_gap_s, 3.0, 1e-12);
}

TEST(Association, EstimatesBeforeAndAfterTheTruthOrInItsGapsAreNotMatched) {
  const Trajectory estimate = sample(tour, 100ms, 20s);
  // truth 5..15 s with no pose strictly between 8 and 9 s: the stamps 8.1 .. 8.9 s are not matched
  const Trajectory truth = with_gap(flights::shifted(sample(tour, 10ms, 10s), 5s), 8s, 9s);
  EXPECT_EQ(matched_poses(estimate, truth).size(), 101U - 9U);
  EXPECT_EQ(associate(estimate, truth).matched, 101U - 9U);
}

TEST(Association, TrajectoriesThatNeverMeetHaveNothingInCommon) {
  const Trajectory estimate = sample(tour, 100ms, 5s);
  const Association found = associate(estimate, flights::shifted(estimate, 10s));
  EXPECT_EQ(found.matched, 0U);
  EXPECT_EQ(found.coverage, 0.0);
  EXPECT_EQ(found.overlap_s, 0.0);
  EXPECT_EQ(associate(Trajectory(), estimate).matched, 0U);
  EXPECT_EQ(associate(estimate, Trajectory()).matched, 0U);
}

TEST(PoseBetween, IsTheInterpolationExceptAcrossAGap) {
  const Trajectory t = with_gap(sample(tour, 100ms, 5s), 2s, 3s);
  const Time gap_limit = gap_limit_of(t);
  EXPECT_EQ(gap_limit, Time(150ms));
  EXPECT_TRUE(pose_between(t, 1234ms, gap_limit)->isApprox(*t.at(1234ms)));
  EXPECT_TRUE(pose_between(t, 2s, gap_limit).has_value());
  EXPECT_FALSE(pose_between(t, 2s + Time{1}, gap_limit).has_value());
  EXPECT_FALSE(pose_between(t, 3s - Time{1}, gap_limit).has_value());
  EXPECT_TRUE(pose_between(t, 3s, gap_limit).has_value());
  EXPECT_TRUE(pose_between(t, 5s, gap_limit).has_value());
  EXPECT_FALSE(pose_between(t, 5s + Time{1}, gap_limit).has_value());
  EXPECT_FALSE(pose_between(Trajectory(), 1s, gap_limit).has_value());
}

}  // namespace
}  // namespace lidarena::evaluation
