// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/fast_lio2/local_map.hpp"

#include <gtest/gtest.h>

namespace lidarena::odometry::fast_lio2 {
namespace {

TEST(FastLio2Map, KeepsThePointNearestToTheCenterOfACell) {
  map::KdTree map;
  map.build({{0.1F, 0.1F, 0.1F}, {5.1F, 5.1F, 5.1F}, {-5, 0, 0}, {-5, 1, 0}, {-5, 2, 0}});
  const std::vector<Eigen::Vector3f> points{{0.2F, 0.2F, 0.2F},     // better than the first
                                            {5.01F, 5.01F, 5.01F},  // worse than the second
                                            {0.6F, 20.0F, 20.0F},   // in an empty cell,
                                            {0.9F, 20.0F, 20.0F}};  // and another one in it
  std::vector<Neighbors> neighbors(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) map.nearest(points[i], neighbors[i]);
  insert_scan(points, neighbors, 0.5F, map);
  std::size_t near_origin = 0;
  for (const Eigen::Vector3f& point : map.points()) {
    EXPECT_NE(point, points[1]);
    if (point.norm() > 1.0F) continue;
    ++near_origin;
    EXPECT_EQ(point, points[0]);
  }
  EXPECT_EQ(near_origin, 1U);
  EXPECT_EQ(map.size(), 7U) << "points of one scan in an empty cell do not thin each other";
}

TEST(FastLio2Map, TheBoxMovesWhenTheSensorComesNearAFace) {
  map::KdTree map;
  for (int i = -60; i <= 60; ++i) map.insert({static_cast<float>(i), 0.0F, 0.0F});
  MapBox box(100.0, 20.0);  // margin 30 m; moves by 0.45 (100 - 60) = 18 m
  box.follow({0, 0, 0}, map);
  box.follow({19.0F, 0, 0}, map);
  EXPECT_EQ(box.box().min().x(), -50.0F);
  EXPECT_EQ(map.size(), 121U);
  box.follow({20.5F, 0, 0}, map);
  EXPECT_EQ(box.box().min().x(), -32.0F);
  EXPECT_EQ(box.box().max().x(), 68.0F);
  EXPECT_EQ(box.box().min().y(), -50.0F);
  EXPECT_EQ(map.size(), 121U - 19U) << "-50 to -32 are removed; those outside of the box stay";
  box.follow({-10.0F, 0, 0}, map);
  EXPECT_EQ(box.box().min().x(), -50.0F);
  EXPECT_EQ(map.size(), 121U - 19U - 11U) << "50 to 60, where the map ends";
}

}  // namespace
}  // namespace lidarena::odometry::fast_lio2
