// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lio/local_map.hpp"

#include <gtest/gtest.h>

namespace lidarena::odometry::arena_lio {
namespace {

TEST(ArenaLioMap, FollowsTheSensor) {
  map::KdTree map;
  for (int i = -100; i <= 100; ++i) map.insert({static_cast<float>(i), 0.0F, 0.0F});
  MapWindow window(40.0);
  window.follow({5.0F, 0.0F, 0.0F}, map);
  EXPECT_EQ(map.size(), 201U) << "less than a quarter of 40 m";
  window.follow({20.0F, 0.0F, 0.0F}, map);
  EXPECT_EQ(map.size(), 79U) << "-19 .. 59";
  for (const Eigen::Vector3f& point : map.points()) {
    EXPECT_GT(point.x(), -20.5F);
    EXPECT_LT(point.x(), 60.5F);
  }
}

}  // namespace
}  // namespace lidarena::odometry::arena_lio
