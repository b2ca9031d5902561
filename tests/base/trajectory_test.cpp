// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/base/trajectory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "lidarena/base/error.hpp"
#include "lidarena/base/so3.hpp"

namespace lidarena {
namespace {

using ::testing::HasSubstr;

StampedPose pose_at(int ms, double x, double yaw) {
  return {std::chrono::milliseconds(ms),
          make_pose(so3::exp({0, 0, yaw}), Eigen::Vector3d(x, 0, 0))};
}

template <class F>
std::string error_of(F&& f) {
  try {
    f();
  } catch (const InputError& e) {
    return e.what();
  }
  return "no error";
}

TEST(Trajectory, InterpolatesLinearlyInPositionAndAngleAndNeverExtrapolates) {
  const Trajectory t({pose_at(0, 0, 0), pose_at(100, 1, 0.4), pose_at(300, 5, 0.4)});
  const auto quarter = t.at(std::chrono::milliseconds(25));
  ASSERT_TRUE(quarter);
  EXPECT_NEAR(quarter->translation().x(), 0.25, 1e-12);
  EXPECT_NEAR(so3::log(quarter->linear()).z(), 0.1, 1e-12);
  EXPECT_NEAR(t.at(std::chrono::milliseconds(300))->translation().x(), 5.0, 1e-12);
  EXPECT_FALSE(t.at(Time{-1}));
  EXPECT_FALSE(t.at(std::chrono::milliseconds(300) + Time{1}));
  EXPECT_NEAR(t.path_length(), 5.0, 1e-12);
  EXPECT_FALSE(Trajectory().at(Time{0}));
}

TEST(Trajectory, TimeRunningBackwardsAndNonFinitePosesAreRefusedByPlace) {
  EXPECT_THAT(error_of([] {
                Trajectory({pose_at(5, 0, 0), pose_at(5, 1, 0)}, "x.tum");
              }),
              HasSubstr("x.tum: pose 2: its time is not later"));
  auto bad = pose_at(7, 0, 0);
  bad.world_from_body.translation().y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(error_of([&] { Trajectory({pose_at(5, 0, 0), bad}); }), HasSubstr("not finite"));
}

}  // namespace
}  // namespace lidarena
