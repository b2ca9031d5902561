// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/kiss_icp/adaptive_threshold.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/odometry/kiss_icp/motions.hpp"

namespace lidarena::odometry::kiss_icp {
namespace {

Pose at(double x) { return pose_of(x, 0, 0, 0, 0, 0); }

TEST(AdaptiveThreshold, DisplacementIsHowFarAPointAtTheRangeMoves) {
  // for a rotation about z, all points of the circle of 50 m in the x-y plane move farthest
  const Pose turned = pose_of(0, 0, 0, 0, 0, 0.3);
  const Eigen::Vector3d point(30.0, 40.0, 0.0);
  EXPECT_NEAR(displacement(turned, 50.0), (turned * point - point).norm(), 1e-12);
  EXPECT_NEAR(displacement(pose_of(3, 0, 4, 0, 0, 0), 50.0), 5.0, 1e-12);
}

TEST(AdaptiveThreshold, OfHeadIsTheRootMeanSquareOfTheFirstGuessAndLargeErrors) {
  Config config;
  config.release = Release::kHead;
  config.initial_threshold_m = 2.0;
  AdaptiveThreshold threshold(config);
  EXPECT_EQ(threshold.sigma(), 2.0);
  threshold.observe(Pose::Identity(), at(0.09));
  EXPECT_EQ(threshold.sigma(), 2.0) << "below the minimum motion of 0.1 m";
  threshold.observe(Pose::Identity(), at(0.5));
  threshold.observe(pose_of(0, 7, 0, 0, 0, 1), pose_of(0, 8, 0, 0, 0, 1));
  EXPECT_NEAR(threshold.sigma(), std::sqrt((4.0 + 0.25 + 1.0) / 3.0), 1e-12);
}

TEST(AdaptiveThreshold, OfV02CountsNoErrorWithinHalfAMeterFromTheStart) {
  Config config;
  config.release = Release::kV0_2;
  AdaptiveThreshold threshold(config);
  EXPECT_EQ(threshold.sigma(), 2.0);
  threshold.observe(Pose::Identity(), at(0.3));
  EXPECT_EQ(threshold.sigma(), 2.0) << "0.3 m from the start";
  threshold.observe(at(0.69), at(0.7));
  EXPECT_EQ(threshold.sigma(), 2.0) << "no error above 0.1 m so far";
  threshold.observe(at(0.7), at(1.1));
  EXPECT_NEAR(threshold.sigma(), 0.4, 1e-12) << "neither the first guess nor the 0.3 m count";
  threshold.observe(at(1.1), at(1.3));
  EXPECT_NEAR(threshold.sigma(), std::sqrt((0.16 + 0.04) / 2.0), 1e-12);
}

TEST(AdaptiveThreshold, OfV02IsTheFirstGuessAgainWheneverTheSensorIsNearTheStart) {
  Config config;
  config.release = Release::kV0_2;
  AdaptiveThreshold threshold(config);
  threshold.observe(at(0.6), at(1.0));
  EXPECT_NEAR(threshold.sigma(), 0.4, 1e-12);
  threshold.observe(at(1.0), at(0.49));
  EXPECT_EQ(threshold.sigma(), 2.0);
  threshold.observe(at(0.8), at(0.6));
  EXPECT_NEAR(threshold.sigma(), std::sqrt((0.16 + 0.04) / 2.0), 1e-12)
      << "what was counted before is kept, the error of 0.51 m near the start is not in it";
}

TEST(AdaptiveThreshold, AnglesAreMeasuredAtTheMaximumRange) {
  const Pose turned = pose_of(0, 0, 0, 0, 0, 0.1);
  Config config;
  config.release = Release::kHead;
  config.initial_threshold_m = 1e-9;
  config.max_range_m = 40.0;
  AdaptiveThreshold threshold(config);
  threshold.observe(Pose::Identity(), turned);
  EXPECT_NEAR(threshold.sigma(), displacement(turned, 40.0) / std::sqrt(2.0), 1e-9);
}

}  // namespace
}  // namespace lidarena::odometry::kiss_icp
