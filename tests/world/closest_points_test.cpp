// SPDX-License-Identifier: BSD-3-Clause
// closest_points() searches for groups of points; each result must be equal to that of a search
// over all triangles one by one.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "lidarena/base/random.hpp"
#include "lidarena/world/triangle_frame.hpp"
#include "lidarena/world/world.hpp"
#include "tests/world/every_ray_caster.hpp"
#include "tests/world/shapes.hpp"

namespace lidarena::world {
namespace {

using Eigen::Vector3d;

class ClosestPoints : public testing::EveryRayCaster {
 protected:
  static void expect_same(const TriangleMesh& mesh, const std::vector<Vector3d>& points,
                          double max_distance);
};
INSTANTIATE_TEST_SUITE_P(With, ClosestPoints, testing::every_ray_caster(),
                         testing::ray_caster_name);

constexpr double kFar = std::numeric_limits<double>::infinity();

ClosestPoint one_by_one(const TriangleMesh& mesh, const Vector3d& point, double max_distance) {
  ClosestPoint best;
  double best2 = max_distance * max_distance;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const Vector3d foot =
        closest_point_on_triangle(point, mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]);
    const double distance2 = (foot - point).squaredNorm();
    if (distance2 < best2 || (distance2 == best2 && !best.valid())) {
      best2 = distance2;
      best = {foot, std::sqrt(distance2), t};
    }
  }
  return best;
}

void ClosestPoints::expect_same(const TriangleMesh& mesh, const std::vector<Vector3d>& points,
                                double max_distance) {
  const World world = make_world(mesh);
  ASSERT_EQ(world.mesh().triangles.size(), mesh.triangles.size());
  std::vector<ClosestPoint> found(points.size());
  world.closest_points(points, max_distance, found, Parallel(2));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const ClosestPoint expected = one_by_one(mesh, points[i], max_distance);
    ASSERT_EQ(found[i].triangle, expected.triangle) << "point " << i;
    ASSERT_EQ(found[i].distance, expected.distance) << "point " << i;
    ASSERT_EQ(found[i].point, expected.point) << "point " << i;
  }
}

/// Squares of 0.25 m in z = 0, two triangles each: points above grid lines have several nearest
/// triangles.
TriangleMesh floor_of_squares(std::uint32_t cells) {
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i <= cells; ++i) {
    for (std::uint32_t j = 0; j <= cells; ++j) mesh.vertices.emplace_back(0.25 * i, 0.25 * j, 0.0);
  }
  for (std::uint32_t i = 0; i < cells; ++i) {
    for (std::uint32_t j = 0; j < cells; ++j) {
      const std::uint32_t a = i * (cells + 1) + j;
      const std::uint32_t b = a + cells + 1;
      mesh.triangles.push_back({a, b, b + 1});
      mesh.triangles.push_back({a, b + 1, a + 1});
    }
  }
  return mesh;
}

/// A random walk with steps of length `step`: consecutive points are close together.
std::vector<Vector3d> walk(std::size_t count, double step, double reach) {
  SequentialRandom random(51);
  std::vector<Vector3d> points(count, Vector3d::Zero());
  for (std::size_t i = 1; i < count; ++i) {
    points[i] =
        (points[i - 1] + step * testing::random_direction(random)).cwiseMin(reach).cwiseMax(-reach);
  }
  return points;
}

TEST_P(ClosestPoints, OfAWalkThroughASoupAreThoseOfAllTrianglesOneByOne) {
  const TriangleMesh soup = testing::triangle_soup(1500, 5.0, 52);
  for (const double step : {0.01, 0.1, 1.0, 30.0}) expect_same(soup, walk(700, step, 50.0), kFar);
}

TEST_P(ClosestPoints, WithinALimitAreThoseOfAllTrianglesOneByOne) {
  const TriangleMesh soup = testing::triangle_soup(300, 5.0, 53);
  for (const double limit : {0.05, 0.3, 2.0}) expect_same(soup, walk(700, 0.1, 8.0), limit);
}

TEST_P(ClosestPoints, OfEquallyNearTrianglesAreThoseWithTheLowestIndex) {
  const TriangleMesh floor = floor_of_squares(8);
  std::vector<Vector3d> points;
  // every eighth of a meter: above corners (six triangles), edges (two), diagonals (two), faces
  for (int i = 0; i <= 16; ++i) {
    for (int j = 0; j <= 16; ++j) points.emplace_back(0.125 * i, 0.125 * j, 0.0625);
  }
  expect_same(floor, points, kFar);
  for (Vector3d& p : points) p.z() = 0.0;  // on the surface: all distances are zero
  expect_same(floor, points, kFar);
  for (Vector3d& p : points) p.z() = 0.25;
  expect_same(floor, points, 0.25);  // exactly at the limit
}

TEST_P(ClosestPoints, OfAFineFloorThatOverflowsAGroupAreThoseOfAllTrianglesOneByOne) {
  // From 3 m above, thousands of triangles are nearly as close as the nearest.
  std::vector<Vector3d> points = walk(200, 0.02, 10.0);
  for (Vector3d& p : points) p += Vector3d(4.0, 4.0, 3.0);
  expect_same(floor_of_squares(32), points, kFar);
}

TEST_P(ClosestPoints, FarFromTheOriginAreThoseOfAllTrianglesOneByOne) {
  const Vector3d far(5.0e5, 5.4e6, 300.0);
  TriangleMesh shifted;
  shifted.append(testing::triangle_soup(500, 5.0, 54),
                 make_pose(Eigen::Matrix3d(Eigen::Matrix3d::Identity()), far));
  std::vector<Vector3d> points = walk(500, 0.05, 5.0);
  for (Vector3d& p : points) p += far;
  expect_same(shifted, points, kFar);
}

TEST_P(ClosestPoints, APointThatIsNotFiniteHasNoneAndHarmsNoNeighbor) {
  const TriangleMesh soup = testing::triangle_soup(300, 5.0, 55);
  std::vector<Vector3d> points = walk(100, 0.01, 5.0);
  points[0].x() = std::numeric_limits<double>::quiet_NaN();
  points[41].y() = std::numeric_limits<double>::infinity();
  const World world = make_world(soup);
  std::vector<ClosestPoint> found(points.size());
  world.closest_points(points, kFar, found, Parallel(1));
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i == 0 || i == 41) {
      EXPECT_FALSE(found[i].valid());
    } else {
      EXPECT_EQ(found[i].triangle, one_by_one(soup, points[i], kFar).triangle) << "point " << i;
    }
  }
}

TEST(TriangleFrame, HasTheDistancesOfTheTriangle) {
  SequentialRandom random(56);
  for (int i = 0; i < 2000; ++i) {
    // from well-shaped triangles to slivers a thousand times longer than wide
    const double thin = std::pow(10.0, -3.0 * random.uniform());
    const Vector3d a = testing::random_point(random, 2.0);
    const Vector3d b = testing::random_point(random, 2.0);
    const Vector3d c = a + random.uniform() * (b - a) + thin * testing::random_point(random, 2.0);
    const Vector3d p = testing::random_point(random, 4.0);
    const double expected = (closest_point_on_triangle(p, a, b, c) - p).squaredNorm();
    // rounding grows with the ratio of length to width
    EXPECT_NEAR(TriangleFrame(a, b, c).squared_distance(p, kFar), expected, 1e-12 / thin);
  }
}

}  // namespace
}  // namespace lidarena::world
