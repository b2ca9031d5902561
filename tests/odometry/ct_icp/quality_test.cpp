// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/ct_icp/quality.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "lidarena/base/so3.hpp"

namespace lidarena::odometry::ct_icp {
namespace {

constexpr double kDegree = M_PI / 180.0;
const RegistrationConfig kLimits;

ElasticMotion motion_of(double degrees, double meters = 0.0) {
  return {Pose::Identity(), make_pose(so3::exp({0, 0, degrees * kDegree}), {meters, 0.0, 0.0})};
}

TEST(CtIcpQuality, LimitsTheMotionOfAScan) {
  const Pose start = Pose::Identity();
  EXPECT_TRUE(is_plausible(motion_of(29.0, 4.9), start, kLimits));
  EXPECT_FALSE(is_plausible(motion_of(31.0), start, kLimits));
  EXPECT_FALSE(is_plausible(motion_of(0.0, 5.1), start, kLimits));
  EXPECT_FALSE(is_plausible(motion_of(0.0, std::nan("")), start, kLimits));
  const Pose turned = make_pose(so3::exp({0, 0, -20.0 * kDegree}), Eigen::Vector3d::Zero());
  EXPECT_TRUE(is_plausible(motion_of(9.0), turned, kLimits));
  EXPECT_FALSE(is_plausible(motion_of(11.0), turned, kLimits))
      << "31 deg from the end of the last scan";
}

TEST(CtIcpQuality, TheLimitsAreKeys) {
  const Pose start = Pose::Identity();
  RegistrationConfig wide;
  wide.max_rotation_deg = 120.0;
  wide.max_translation_m = 8.0;
  EXPECT_TRUE(is_plausible(motion_of(119.0, 7.9), start, wide));
  EXPECT_FALSE(is_plausible(motion_of(121.0), start, wide));
  EXPECT_FALSE(is_plausible(motion_of(0.0, 8.1), start, wide));
}

TEST(CtIcpQuality, ScansThatTurnAreKeptOutUntilSixWere) {
  InsertionGate gate;
  EXPECT_TRUE(gate.admits(motion_of(2.9)));
  for (int round = 0; round < 2; ++round) {
    for (int i = 0; i < 6; ++i) EXPECT_FALSE(gate.admits(motion_of(3.1)));
    EXPECT_TRUE(gate.admits(motion_of(3.1))) << "more than five in a row";
  }
  EXPECT_FALSE(gate.admits(motion_of(3.1)));
  EXPECT_TRUE(gate.admits(motion_of(2.9)));
}

}  // namespace
}  // namespace lidarena::odometry::ct_icp
