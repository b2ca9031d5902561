// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lo/prediction.hpp"

#include <gtest/gtest.h>

#include "lidarena/base/so3.hpp"

namespace lidarena::odometry::arena_lo {
namespace {

constexpr Time kPeriod{100'000'000};

estimation::ScanTimes times_of_scan(int index, bool timed = true) {
  return {index * kPeriod, (index + 1) * kPeriod, timed};
}

const Pose& step() {
  static const Pose pose = make_pose(so3::exp({0, 0, 0.1}), {1.0, 0.0, 0.0});
  return pose;
}

/// After one scan that moves by step().
MotionHistory after_one_step() {
  MotionHistory history;
  history.add({{Pose::Identity(), step()}}, times_of_scan(0));
  return history;
}

void expect_near(const Pose& a, const Pose& b) {
  EXPECT_LT((a.matrix() - b.matrix()).norm(), 1e-12);
}

TEST(ArenaLoPrediction, GoesOnWithTheLastVelocityByRealTime) {
  const MotionHistory history = after_one_step();
  const auto next = history.expect(times_of_scan(1), 2, {}).guess;
  ASSERT_EQ(next.knots.size(), 3U);
  expect_near(next.begin(), step());
  expect_near(next.end(), step() * step());
  const auto later = history.expect(times_of_scan(2), 2, {}).guess;  // a scan was dropped
  expect_near(later.begin(), step() * step());
  expect_near(later.end(), step() * step() * step());
  const auto first = MotionHistory{}.expect(times_of_scan(7), 3, {}).guess;
  expect_near(first.end(), Pose::Identity());
}

TEST(ArenaLoPrediction, ThePriorExpectsThePrediction) {
  const Expectation expected = after_one_step().expect(times_of_scan(1), 3, {});
  expect_near(expected.prior.begin, expected.guess.begin());
  EXPECT_LT((expected.prior.step - step().linear() * step().translation()).norm(), 1e-12);
  EXPECT_EQ(expected.prior.location, PriorConfig{}.location);
  EXPECT_EQ(expected.prior.angular_velocity_change, PriorConfig{}.angular_velocity_change);
}

TEST(ArenaLoPrediction, AfterEachLostScanTheVelocityIsHalved) {
  MotionHistory history = after_one_step();
  for (int i = 1; i <= 2; ++i)
    history.add_lost(history.expect(times_of_scan(i), 1, {}).guess, times_of_scan(i));
  const auto next = history.expect(times_of_scan(3), 1, {}).guess;
  const Pose moved = next.begin().inverse() * next.end();
  EXPECT_NEAR(so3::angle(moved.linear()), 0.1 / 4.0, 1e-12);
}

TEST(ArenaLoPrediction, OfScansWithoutTimesTheMotionIsFromEndToEnd) {
  MotionHistory history;
  history.add(estimation::ElasticMotion::still(Pose::Identity(), 1), times_of_scan(0, false));
  history.add(estimation::ElasticMotion::still(step(), 1), times_of_scan(1, false));
  expect_near(history.expect(times_of_scan(2, false), 1, {}).guess.end(), step() * step());
}

}  // namespace
}  // namespace lidarena::odometry::arena_lo
