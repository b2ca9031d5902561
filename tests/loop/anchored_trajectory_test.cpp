// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/loop/anchored_trajectory.hpp"

#include <gtest/gtest.h>

#include "lidarena/base/so3.hpp"

namespace lidarena::loop {
namespace {

Pose at_x(double meters) { return make_pose(Eigen::Matrix3d::Identity(), {meters, 0.0, 0.0}); }

/// Keyframes at 0, 10 and 20 s, 1 m apart; a pose every second, each 0.1 m further.
AnchoredTrajectory straight() {
  AnchoredTrajectory trajectory;
  for (int i = 0; i <= 25; ++i) {
    const Time stamp = from_seconds(i);
    if (i % 10 == 0) trajectory.add_anchor(stamp, at_x(i == 0 ? 0.0 : 1.0));
    trajectory.add(stamp, at_x(0.1 * (i % 10)));
  }
  return trajectory;
}

TEST(AnchoredTrajectory, IsWhatWasAddedWhileTheKeyframesStayInPlace) {
  const auto placed = straight().placed(std::vector{at_x(0.0), at_x(1.0), at_x(2.0)});
  ASSERT_EQ(placed.size(), 26U);
  for (std::size_t i = 0; i < placed.size(); ++i)
    EXPECT_NEAR(placed[i].world_from_body.translation().x(), 0.1 * static_cast<double>(i), 1e-12);
}

TEST(AnchoredTrajectory, SharesAStretchOutEvenlyAndMovesTheRestAlong) {
  const auto placed = straight().placed(std::vector{at_x(0.0), at_x(1.5), at_x(2.5)});
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const auto t = static_cast<double>(i);
    const double expected = t <= 10.0 ? 0.15 * t : 0.1 * t + 0.5;
    EXPECT_NEAR(placed[i].world_from_body.translation().x(), expected, 1e-12) << i;
  }
}

TEST(AnchoredTrajectory, TurnsAreSharedOutWithoutAJump) {
  const Pose turned = make_pose(so3::exp({0.0, 0.0, 0.3}), {1.0, 0.2, 0.0});
  const auto placed = straight().placed(std::vector{at_x(0.0), turned, turned * at_x(1.0)});
  for (std::size_t i = 1; i < placed.size(); ++i) {
    const Pose step = placed[i - 1].world_from_body.inverse() * placed[i].world_from_body;
    EXPECT_LT(step.translation().norm(), 0.13) << i;
    EXPECT_LT(so3::angle(step.linear()), 0.031) << i;
  }
}

TEST(AnchoredTrajectory, BeforeTheFirstKeyframePosesStandInTheWorldAndTimeGoesOn) {
  AnchoredTrajectory trajectory;
  trajectory.add(from_seconds(1), at_x(3.0));
  trajectory.add(from_seconds(1), at_x(4.0));
  EXPECT_EQ(trajectory.size(), 1U);
  EXPECT_EQ(trajectory.placed({}).front().world_from_body.translation().x(), 3.0);
}

TEST(AnchoredTrajectory, OnlyTheLastPoseIsRevised) {
  AnchoredTrajectory trajectory = straight();
  trajectory.revise(from_seconds(25), at_x(0.7));
  trajectory.revise(from_seconds(24), at_x(9.0));
  const auto placed = trajectory.placed(std::vector{at_x(0.0), at_x(1.0), at_x(2.0)});
  EXPECT_NEAR(placed[24].world_from_body.translation().x(), 2.4, 1e-12);
  EXPECT_NEAR(placed[25].world_from_body.translation().x(), 2.7, 1e-12);
}

}  // namespace
}  // namespace lidarena::loop
