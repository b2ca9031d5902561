// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/tracking.hpp"

#include <gtest/gtest.h>

namespace lidarena::odometry {
namespace {

TEST(Tracking, AScanContradictsTheMapBelowItsShareOfTheUsualInliers) {
  Tracking tracking(TrackingConfig{.min_inlier_share = 0.5});
  EXPECT_EQ(tracking.judge(0.4, false), ScanStatus::kTracked) << "the first one is usual";
  EXPECT_EQ(tracking.judge(0.8, false), ScanStatus::kTracked);
  // usual: 0.9 * 0.4 + 0.1 * 0.8 = 0.44
  EXPECT_EQ(tracking.judge(0.219, false), ScanStatus::kDegenerate);
  EXPECT_TRUE(tracking.contradicts());
  EXPECT_EQ(tracking.judge(0.221, false), ScanStatus::kTracked) << "a bad one does not count";
  EXPECT_FALSE(tracking.contradicts());
}

TEST(Tracking, AScanThatLeavesADirectionOpenIsDegenerateAndDoesNotContradict) {
  Tracking tracking(TrackingConfig{});
  EXPECT_EQ(tracking.judge(0.5, true), ScanStatus::kDegenerate);
  EXPECT_FALSE(tracking.contradicts());
  EXPECT_EQ(tracking.judge(0.5, false), ScanStatus::kTracked);
}

TEST(Tracking, IsLostAfterMoreThanFifteenContradictionsInARow) {
  Tracking tracking(TrackingConfig{});
  tracking.judge(0.5, false);
  for (int i = 0; i < 15; ++i) tracking.judge(0.1, false);
  EXPECT_FALSE(tracking.is_lost());
  tracking.judge(0.1, false);
  EXPECT_TRUE(tracking.is_lost());
  tracking.judge(0.5, false);
  EXPECT_FALSE(tracking.is_lost()) << "whether that lasts is for the method to say";
  tracking.give_up();
  EXPECT_TRUE(tracking.is_lost() && tracking.contradicts());
}

}  // namespace
}  // namespace lidarena::odometry
