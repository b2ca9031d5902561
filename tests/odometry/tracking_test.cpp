// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/tracking.hpp"

#include <gtest/gtest.h>

namespace lidarena::odometry {
namespace {

const Eigen::Matrix3d kIsotropic = Eigen::Matrix3d::Identity();

TEST(Tracking, AScanContradictsTheMapBelowItsShareOfTheUsualInliers) {
  Tracking tracking(TrackingConfig{.min_inlier_share = 0.5});
  EXPECT_EQ(tracking.judge(0.4, kIsotropic), ScanStatus::kTracked) << "the first one is usual";
  EXPECT_EQ(tracking.judge(0.8, kIsotropic), ScanStatus::kTracked);
  // usual: 0.9 * 0.4 + 0.1 * 0.8 = 0.44
  EXPECT_EQ(tracking.judge(0.219, kIsotropic), ScanStatus::kDegenerate);
  EXPECT_TRUE(tracking.contradicts());
  EXPECT_EQ(tracking.judge(0.221, kIsotropic), ScanStatus::kTracked) << "a bad one does not count";
  EXPECT_FALSE(tracking.contradicts());
}

TEST(Tracking, ADirectionWithLessThanAHundredthOfTheInformationIsDegenerate) {
  Tracking tracking(TrackingConfig{});
  EXPECT_EQ(tracking.judge(0.5, Eigen::Vector3d(1.0, 1.0, 0.0201).asDiagonal()),
            ScanStatus::kDegenerate);
  EXPECT_FALSE(tracking.contradicts());
  EXPECT_EQ(tracking.judge(0.5, Eigen::Vector3d(1.0, 1.0, 0.0203).asDiagonal()),
            ScanStatus::kTracked);
}

TEST(Tracking, IsLostAfterMoreThanFifteenContradictionsInARow) {
  Tracking tracking(TrackingConfig{});
  tracking.judge(0.5, kIsotropic);
  for (int i = 0; i < 15; ++i) tracking.judge(0.1, kIsotropic);
  EXPECT_FALSE(tracking.is_lost());
  tracking.judge(0.1, kIsotropic);
  EXPECT_TRUE(tracking.is_lost());
  tracking.judge(0.5, kIsotropic);
  EXPECT_FALSE(tracking.is_lost()) << "whether that lasts is for the method to say";
  tracking.give_up();
  EXPECT_TRUE(tracking.is_lost() && tracking.contradicts());
}

}  // namespace
}  // namespace lidarena::odometry
