// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/kiss_icp_head/adaptive_threshold.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/odometry/kiss_icp/motions.hpp"

namespace lidarena::odometry::kiss_icp_head {
namespace {

using kiss_icp::Config;
using kiss_icp::displacement;
using kiss_icp::pose_of;

Pose at(double x) { return pose_of(x, 0, 0, 0, 0, 0); }

TEST(AdaptiveThreshold, IsTheRootMeanSquareOfTheFirstGuessAndLargeErrors) {
  Config config;
  config.initial_threshold_m = 2.0;
  AdaptiveThreshold threshold(config);
  EXPECT_EQ(threshold.sigma(), 2.0);
  threshold.observe(Pose::Identity(), at(0.09));
  EXPECT_EQ(threshold.sigma(), 2.0) << "below the minimum motion of 0.1 m";
  threshold.observe(Pose::Identity(), at(0.5));
  threshold.observe(pose_of(0, 7, 0, 0, 0, 1), pose_of(0, 8, 0, 0, 0, 1));
  EXPECT_NEAR(threshold.sigma(), std::sqrt((4.0 + 0.25 + 1.0) / 3.0), 1e-12);
}

TEST(AdaptiveThreshold, AnglesAreMeasuredAtTheMaximumRange) {
  const Pose turned = pose_of(0, 0, 0, 0, 0, 0.1);
  Config config;
  config.initial_threshold_m = 1e-9;
  config.max_range_m = 40.0;
  AdaptiveThreshold threshold(config);
  threshold.observe(Pose::Identity(), turned);
  EXPECT_NEAR(threshold.sigma(), displacement(turned, 40.0) / std::sqrt(2.0), 1e-9);
}

}  // namespace
}  // namespace lidarena::odometry::kiss_icp_head
