// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/map/neighborhood.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace lidarena::map {
namespace {

std::vector<Neighbor> neighbors_of(const std::vector<Eigen::Vector3f>& points) {
  std::vector<Neighbor> all;
  for (const auto& point : points) all.push_back({point, 0.0F});
  return all;
}

TEST(Neighborhood, OfAPlaneKnowsItsNormalItsPlanarityAndItsMean) {
  // the plane z = 2, with twice the spread along x as along y; far away, where floats are coarse
  std::vector<Eigen::Vector3f> points;
  for (int i = -2; i <= 2; ++i) {
    for (int j = -2; j <= 2; ++j)
      points.emplace_back(50.0F + 0.25F * static_cast<float>(i), 0.125F * static_cast<float>(j),
                          2.0F);
  }
  const Neighborhood found = describe(neighbors_of(points));
  EXPECT_NEAR(std::abs(found.normal.z()), 1.0, 1e-6);
  EXPECT_NEAR(found.planarity, 0.5, 1e-3) << "deviations 2 : 1 : 0";
  EXPECT_LT((found.mean - Eigen::Vector3d(50, 0, 2)).norm(), 1e-6);
}

TEST(Neighborhood, OfALineIsNotPlanar) {
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 10; ++i) points.emplace_back(0.1F * static_cast<float>(i), 1.0F, 2.0F);
  EXPECT_NEAR(describe(neighbors_of(points)).planarity, 0.0, 1e-3);
}

TEST(Neighborhood, OfOnePointManyTimesHasNoShapeAndNoNan) {
  const Neighborhood found =
      describe(neighbors_of(std::vector<Eigen::Vector3f>(10, Eigen::Vector3f(1, 2, 3))));
  EXPECT_EQ(found.planarity, 0.0);
  EXPECT_TRUE(found.normal.allFinite());
}

}  // namespace
}  // namespace lidarena::map
