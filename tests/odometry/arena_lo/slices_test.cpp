// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lo/slices.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "lidarena/base/so3.hpp"

namespace lidarena::odometry::arena_lo {
namespace {

/// 100 points, one each ms.
Scan arena_lo_scan() {
  Scan scan{.stamp = Time{5'000'000'000}, .points = {}, .timed = true};
  for (int i = 0; i < 100; ++i)
    scan.points.push_back({{1.0F + 0.01F * static_cast<float>(i), 0, 0}, 0, i * 1'000'000});
  return scan;
}

TEST(ArenaLoSlices, EachPointIsInTheSliceOfItsTime) {
  const Scan scan = arena_lo_scan();
  const auto times = estimation::times_of(scan, Time{100'000'000});
  const auto slices = slices_of(scan, times, 0.01, Config{});
  ASSERT_EQ(slices.size(), 10U) << "99 ms in slices of 9.9 ms";
  EXPECT_EQ(count_points(slices), 100U);
  for (const Slice& slice : slices) {
    for (const Slice::Point& point : slice.points) {
      EXPECT_LE(std::abs(point.seconds), 0.00496F);
      const double instant = to_seconds(slice.middle - scan.stamp) + point.seconds;
      EXPECT_NEAR(instant, (point.position.x() - 1.0F) / 10.0, 1e-6);
    }
  }
}

TEST(ArenaLoSlices, PointsOutsideOfTheRangeLimitsAndThoseNotFiniteAreLeftOut) {
  Scan scan = arena_lo_scan();
  scan.points[3].position.y() = std::numeric_limits<float>::quiet_NaN();
  scan.points[4].position.x() = 150.0F;
  scan.points[5].position.x() = 0.05F;
  const auto times = estimation::times_of(scan, Time{100'000'000});
  EXPECT_EQ(count_points(slices_of(scan, times, 0.01, Config{})), 97U);
}

TEST(ArenaLoSlices, AScanWithoutTimesIsOneSlice) {
  Scan scan = arena_lo_scan();
  scan.timed = false;
  for (Point& point : scan.points) point.dt_ns = 0;
  const auto slices =
      slices_of(scan, estimation::times_of(scan, Time{100'000'000}), 0.01, Config{});
  ASSERT_EQ(slices.size(), 1U);
  EXPECT_EQ(slices[0].middle, scan.stamp);
  EXPECT_EQ(slices[0].points.back().seconds, 0.0F);
}

TEST(ArenaLoSlices, PlacedPointsFollowTheMotion) {
  estimation::MotionState motion;
  motion.pose = make_pose(so3::exp({0, 0, 1.0}), {1, 2, 3});
  motion.velocity = {1, 0, 0};
  motion.rate = {0, 0, 5};
  motion.acceleration = {0, 8, 0};
  const Slice slice{Time{0}, {{{2, 0, 0}, 0.01F}, {{2, 0, 0}, 0.01F}, {{0, 3, 0}, -0.01F}}};
  const auto placed_points = placed(slice, motion, Pose::Identity(), Parallel(1));
  ASSERT_EQ(placed_points.size(), 3U);
  const Eigen::Vector3d first =
      so3::exp({0, 0, 1.05}) * Eigen::Vector3d(2, 0, 0) + Eigen::Vector3d(1.01, 2.0004, 3);
  EXPECT_LT((placed_points[0].cast<double>() - first).norm(), 1e-5);
  EXPECT_EQ(placed_points[0], placed_points[1]);
  const Eigen::Vector3d last =
      so3::exp({0, 0, 0.95}) * Eigen::Vector3d(0, 3, 0) + Eigen::Vector3d(0.99, 2.0004, 3);
  EXPECT_LT((placed_points[2].cast<double>() - last).norm(), 1e-5);
}

}  // namespace
}  // namespace lidarena::odometry::arena_lo
