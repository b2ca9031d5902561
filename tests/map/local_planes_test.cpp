// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/map/local_planes.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace lidarena::map {
namespace {

/// A floor 0.6 m wide along x, a point each 5 cm.
std::vector<Eigen::Vector3f> floor_along_x(float begin, float end) {
  std::vector<Eigen::Vector3f> points;
  for (float x = begin; x < end; x += 0.05F) {
    for (int y = 0; y < 12; ++y) points.emplace_back(x, 0.05F * static_cast<float>(y), 0.02F);
  }
  return points;
}

float least_x(const std::vector<Eigen::Vector3f>& points) {
  const auto by_x = [](const auto& a, const auto& b) { return a.x() < b.x(); };
  return std::ranges::min_element(points, by_x)->x();
}

TEST(LocalPlanes, FollowsTheSensorInStepsOfAQuarterOfItsRadius) {
  LocalPlanes map({.radius = 40.0});
  EXPECT_TRUE(map.empty());
  const auto points = floor_along_x(-50.0F, 50.0F);
  map.insert(points);
  EXPECT_FALSE(map.empty());
  const std::size_t all = map.fine().size();
  map.follow({5.0F, 0.0F, 0.0F});
  EXPECT_EQ(map.fine().size(), all) << "less than a quarter of 40 m";
  map.follow({20.0F, 0.0F, 0.0F});
  EXPECT_NEAR(least_x(map.fine().centers()), -20.0F, 0.4F) << "to the edge of a cell of 0.3 m";
  EXPECT_NEAR(least_x(map.coarse().centers()), -20.0F, 1.2F) << "of 0.9 m";
  map.clear();
  EXPECT_TRUE(map.empty());
  EXPECT_EQ(map.fine().size(), 0U);
}

TEST(LocalPlanes, ACoarseCellServesWhereTheFineOneHasNoPlane) {
  LocalPlanes map({});
  std::vector<Eigen::Vector3f> sparse;
  for (int i = 0; i < 400; ++i)
    sparse.emplace_back(0.25F * static_cast<float>(i % 20), 0.25F * static_cast<float>(i / 20),
                        0.0F);
  const Eigen::Vector3f point(2.1F, 2.1F, 0.01F);
  const Eigen::Vector3f above(2.0F, 2.0F, 3.0F);
  map.insert(sparse, above);
  ASSERT_EQ(map.fine().plane_at(point), nullptr);
  EXPECT_EQ(map.plane_at(point, above, false), map.coarse().plane_at(point));
  EXPECT_EQ(map.plane_at(point, above, true), map.coarse().plane_at(point));
}

}  // namespace
}  // namespace lidarena::map
