// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/kiss_icp/adaptive_threshold.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/odometry/kiss_icp/motions.hpp"

namespace lidarena::odometry::kiss_icp {
namespace {

Pose at(double x) { return pose_of(x, 0, 0, 0, 0, 0); }

TEST(AdaptiveThreshold, CountsNoErrorWithinHalfAMeterFromTheStart) {
  AdaptiveThreshold threshold(Config{});
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

TEST(AdaptiveThreshold, IsTheFirstGuessAgainWheneverTheSensorIsNearTheStart) {
  AdaptiveThreshold threshold(Config{});
  threshold.observe(at(0.6), at(1.0));
  EXPECT_NEAR(threshold.sigma(), 0.4, 1e-12);
  threshold.observe(at(1.0), at(0.49));
  EXPECT_EQ(threshold.sigma(), 2.0);
  threshold.observe(at(0.8), at(0.6));
  EXPECT_NEAR(threshold.sigma(), std::sqrt((0.16 + 0.04) / 2.0), 1e-12)
      << "what was counted before is kept, the error of 0.51 m near the start is not in it";
}

}  // namespace
}  // namespace lidarena::odometry::kiss_icp
