// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/kiss_icp/adaptive_threshold.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/odometry/kiss_icp/motions.hpp"

namespace lidarena::odometry::kiss_icp {
namespace {

TEST(AdaptiveThreshold, DisplacementIsHowFarAPointAtTheRangeMoves) {
  // for a rotation about z, all points of the circle of 50 m in the x-y plane move farthest
  const Pose turned = pose_of(0, 0, 0, 0, 0, 0.3);
  const Eigen::Vector3d point(30.0, 40.0, 0.0);
  EXPECT_NEAR(displacement(turned, 50.0), (turned * point - point).norm(), 1e-12);
  EXPECT_NEAR(displacement(pose_of(3, 0, 4, 0, 0, 0), 50.0), 5.0, 1e-12);
}

TEST(AdaptiveThreshold, SigmaIsTheRootMeanSquareOfTheFirstGuessAndLargeErrors) {
  Config config;
  config.initial_threshold_m = 2.0;
  AdaptiveThreshold threshold(config);
  EXPECT_EQ(threshold.sigma(), 2.0);
  threshold.observe(Pose::Identity(), pose_of(0.09, 0, 0, 0, 0, 0), 7.0);
  EXPECT_EQ(threshold.sigma(), 2.0) << "below the minimum motion of 0.1 m";
  threshold.observe(Pose::Identity(), pose_of(0.5, 0, 0, 0, 0, 0), 7.0);
  threshold.observe(pose_of(0, 7, 0, 0, 0, 1), pose_of(0, 8, 0, 0, 0, 1), 7.0);
  EXPECT_NEAR(threshold.sigma(), std::sqrt((4.0 + 0.25 + 1.0) / 3.0), 1e-12);
}

TEST(AdaptiveThreshold, In2023TheFirstGuessHoldsForHalfAMeterAndThenDropsOut) {
  Config config;
  config.threshold_start = ThresholdStart::kUntilMoved;
  AdaptiveThreshold threshold(config);
  threshold.observe(Pose::Identity(), pose_of(0.3, 0, 0, 0, 0, 0), 7.0);
  EXPECT_EQ(threshold.sigma(), 2.0) << "0.3 m from the start";
  threshold.observe(pose_of(0.3, 0, 0, 0, 0, 0), pose_of(0.7, 0, 0, 0, 0, 0), 7.0);
  EXPECT_NEAR(threshold.sigma(), std::sqrt((0.09 + 0.16) / 2.0), 1e-12);
}

TEST(AdaptiveThreshold, WithAMemoryItForgetsLargeErrorsAndSeesSmallOnes) {
  Config config;
  config.initial_threshold_m = 2.0;
  config.threshold_memory = 10.0;
  AdaptiveThreshold threshold(config);
  const Pose small = pose_of(0.02, 0, 0, 0, 0, 0);
  double squares = 4.0, weights = 1.0;
  for (int i = 1; i <= 60; ++i) {
    threshold.observe(Pose::Identity(), small, 7.0);
    squares = squares * std::exp(-0.1) + 0.01;  // errors below 0.1 m count as 0.1 m
    weights = weights * std::exp(-0.1) + 1.0;
    ASSERT_NEAR(threshold.sigma(), std::sqrt(squares / weights), 1e-12) << i;
  }
  EXPECT_LT(threshold.sigma(), 0.11) << "the initial 2 m have lost their weight";
  threshold.observe(Pose::Identity(), pose_of(1.0, 0, 0, 0, 0, 0), 7.0);
  EXPECT_GT(threshold.sigma(), 0.3) << "an error of 1 m has a weight of a tenth at once";
}

TEST(AdaptiveThreshold, TheLeverIsTheMaximumRangeOrTheMeanRangeOfTheScan) {
  const Pose turned = pose_of(0, 0, 0, 0, 0, 0.1);
  Config config;
  config.initial_threshold_m = 1e-9;
  config.max_range_m = 40.0;
  for (const auto& [lever, range] :
       {std::pair{ThresholdLever::kMaxRange, 40.0}, std::pair{ThresholdLever::kMeanRange, 5.0}}) {
    config.threshold_lever = lever;
    AdaptiveThreshold threshold(config);
    threshold.observe(Pose::Identity(), turned, 5.0);
    EXPECT_NEAR(threshold.sigma(), displacement(turned, range) / std::sqrt(2.0), 1e-9);
  }
}

}  // namespace
}  // namespace lidarena::odometry::kiss_icp
