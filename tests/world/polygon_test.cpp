// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/world/polygon.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <numeric>

#include "lidarena/base/pose.hpp"

namespace lidarena::world {
namespace {

using Eigen::Vector3d;

/// A U of 3 x 3 m without its slot of 1 x 2 m: 7 m^2.
std::vector<Vector3d> u_shape() {
  return {{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {2, 3, 0}, {2, 1, 0}, {1, 1, 0}, {1, 3, 0}, {0, 3, 0}};
}

TriangleMesh covered(const std::vector<Vector3d>& vertices, std::uint32_t first) {
  std::vector<std::uint32_t> corners(vertices.size());
  std::iota(corners.begin(), corners.end(), 0U);
  std::ranges::rotate(corners, corners.begin() + first);
  return {vertices, triangulate(corners, vertices), {}, {}};
}

TEST(Polygon, AConcaveOneHasItsAreaWhicheverCornerIsFirst) {
  const Pose tilted = make_pose(Eigen::Quaterniond(0.8, 0.36, 0.0, 0.48), Vector3d(5e5, 5e6, 30));
  for (const bool is_tilted : {false, true}) {
    std::vector<Vector3d> vertices = u_shape();
    if (is_tilted)
      for (Vector3d& vertex : vertices) vertex = tilted * vertex;
    for (std::uint32_t first = 0; first < vertices.size(); ++first) {
      const TriangleMesh mesh = covered(vertices, first);
      EXPECT_EQ(mesh.triangles.size(), 6U);
      EXPECT_NEAR(mesh.area(), 7.0, 1e-6) << first;
      Vector3d twice = Vector3d::Zero();  // all triangles face as the polygon does
      for (std::size_t i = 0; i < mesh.triangles.size(); ++i) twice += mesh.cross(i);
      EXPECT_NEAR(twice.norm(), 14.0, 1e-6);
    }
  }
}

TEST(Polygon, AConvexOneIsAFanAroundItsFirstCorner) {
  const std::vector<Vector3d> square{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  EXPECT_EQ(triangulate(std::vector<std::uint32_t>{1, 2, 3, 0}, square),
            (std::vector<Triangle>{{1, 2, 3}, {1, 3, 0}}));
}

TEST(Polygon, AStarOfManyCornersIsCovered) {
  std::vector<Vector3d> star;
  for (int i = 0; i < 50; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 50.0, radius = i % 2 == 0 ? 2.0 : 1.0;
    star.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0.0);
  }
  // 50 triangles between the center, a tip and a notch
  const double area = 50.0 * 0.5 * 2.0 * 1.0 * std::sin(2.0 * std::numbers::pi / 50.0);
  EXPECT_NEAR(covered(star, 0).area(), area, 1e-9);
  EXPECT_NEAR(covered(star, 7).area(), area, 1e-9);
}

TEST(Polygon, WithoutAreaItGivesTheUsualNumberOfTriangles) {
  const std::vector<Vector3d> line{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 0, 0}};
  EXPECT_EQ(triangulate(std::vector<std::uint32_t>{0, 1, 2, 3}, line).size(), 2U);
}

}  // namespace
}  // namespace lidarena::world
