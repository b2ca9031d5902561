// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/map/vertex_distance.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "lidarena/base/config_json.hpp"
#include "lidarena/base/random.hpp"
#include "meshes.hpp"
#include "tests/evaluation/two_threads.hpp"

namespace lidarena::evaluation {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using ::testing::HasSubstr;

VertexDistance distance_of(const std::vector<Vector3f>& map, const world::World& world,
                           const Pose& mesh_from_map, double edge) {
  const MortonOrder order = morton_order(map, kTwoThreads);
  const std::vector<PointScore> scores =
      score_points(map, order, mesh_from_map, world, kTwoThreads);
  return SubdividedMesh(world, edge).distance_of(map, order, scores, mesh_from_map, kTwoThreads);
}

Vector3d random_point(SequentialRandom& random, double half) {
  const double x = random.uniform(-half, half), y = random.uniform(-half, half);
  return {x, y, random.uniform(-half, half)};
}

/// Unconnected triangles of various sizes and shapes, far from the origin.
world::TriangleMesh soup(std::uint64_t seed, const Vector3d& far) {
  SequentialRandom random(seed);
  world::TriangleMesh mesh;
  for (std::uint32_t t = 0; t < 30; ++t) {
    const Vector3d at = far + random_point(random, 2.0);
    for (int k = 0; k < 3; ++k) {
      mesh.vertices.push_back(at + random_point(random, t % 3 == 0 ? 0.02 : 0.5));
    }
    mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  return mesh;
}

/// Brute-force distance to the nearest of the points (i a + j b + k c) / n of all triangles, n the
/// smallest number for which all sides are at most `edge`.
double slow_distance(const world::TriangleMesh& mesh, const Vector3d& point, double edge) {
  double best = std::numeric_limits<double>::infinity();
  for (const world::Triangle& t : mesh.triangles) {
    const Vector3d a = mesh.vertices[t[0]], b = mesh.vertices[t[1]], c = mesh.vertices[t[2]];
    int n = 1;
    while (std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()}) > n * edge) ++n;
    for (int i = 0; i <= n; ++i) {
      for (int j = 0; j <= n - i; ++j) {
        best = std::min(best, ((i * a + j * b + (n - i - j) * c) / n - point).norm());
      }
    }
  }
  return best;
}

TEST(VertexDistance, IsWhatALookAtAllVerticesFindsOrFarOffWhatTheSurfaceTellsOfThem) {
  const Vector3d far(5000.0, -3000.0, 100.0);
  const world::World world(soup(11, far));
  const Pose mesh_from_map = make_pose(Eigen::Quaterniond(0.8, 0.0, 0.6, 0.0), far);
  SequentialRandom random(12);
  for (const double edge : {0.05, 0.3, 10.0}) {
    std::vector<Vector3f> map;
    std::vector<double> expected;
    for (int i = 0; i < 60; ++i) {
      const double half = i % 10 == 0 ? 100.0 : 2.5;  // some of them far away
      map.push_back(random_point(random, half).cast<float>());
      expected.push_back(
          slow_distance(world.mesh(), mesh_from_map * map.back().cast<double>(), edge));
      // one at a time, to check each distance
      const VertexDistance one = distance_of({map.back()}, world, mesh_from_map, edge);
      const bool beyond = expected.back() > 20.0 * edge;
      ASSERT_NEAR(one.rmse_m.value(), expected.back(),
                  beyond ? edge / 120.0 : 1e-6 + 3e-7 * expected.back());
      ASSERT_LT(one.rmse_m.value(), expected.back() + 1e-5);
    }
    const VertexDistance all = distance_of(map, world, mesh_from_map, edge);
    const MapError slow = summarize_distances(expected);
    EXPECT_NEAR(all.rmse_m.value(), slow.distance_m.rmse, edge / 120.0);
    EXPECT_NEAR(all.median_m.value(), slow.distance_m.median, 1e-5);
    EXPECT_EQ(all.outliers_percent, slow.outliers_percent);
  }
}

TEST(VertexDistance, OfAPlaneIsThatOfASquareLattice) {
  // Legs of 0.9 m, diagonal 1.273 m: 26 pieces, a lattice of h = 3.46 cm. Points at height z over
  // the midpoints of the m x m parts of each cell have the mean square z^2 + h^2 / 6 (1 - 1 / m^2),
  // m even: twice the mean of squares of m / 2 midpoints of [0, h / 2].
  const world::World world(meshes::plane(0.9));
  constexpr int kPieces = 26, kParts = 4;
  const double h = 0.9 / kPieces;
  for (const double z : {0.0, 0.02, 0.05}) {
    std::vector<Vector3f> map;
    for (int i = 0; i < kPieces * kParts; ++i) {
      for (int j = 0; j < kPieces * kParts; ++j) {
        const Vector3d at((i + 0.5) * h / kParts - 0.45, (j + 0.5) * h / kParts - 0.45, z);
        map.push_back(at.cast<float>());
      }
    }
    const VertexDistance found = distance_of(map, world, Pose::Identity(), 0.05);
    EXPECT_EQ(found.points, map.size());
    const double law = z * z + h * h / 6.0 * (1.0 - 1.0 / (kParts * kParts));
    EXPECT_NEAR(found.rmse_m.value(), std::sqrt(law), 1e-6) << z;
    EXPECT_EQ(found.outliers_percent, 0.0);
  }
}

TEST(SubdividedVertices, AreAsManyAsCountedWithCornersOnceAndNoEdgeLongerThanAsked) {
  const world::TriangleMesh plane = meshes::plane(0.9);
  // 27 x 28 / 2 in each of two triangles, less the two corners that they share
  EXPECT_EQ(count_subdivided(plane, 0.05), 2U * 378U - 2U);
  EXPECT_EQ(subdivided_vertices(plane, 0.05, Vector3d::Zero()).size(), 2U * 378U - 2U);
  EXPECT_EQ(subdivided_vertices(plane, 2.0, Vector3d::Zero()).size(), 4U);
  // a right triangle with sides 3, 4 and 5 m: 100 pieces of 5 cm, and one more if 5 cm is not
  // allowed
  world::TriangleMesh triangle;
  triangle.vertices = {{0, 0, 0}, {3, 0, 0}, {0, 4, 0}, {9, 9, 9}};  // the last is unused
  triangle.triangles = {{0, 1, 2}};
  EXPECT_EQ(count_subdivided(triangle, 0.05), 101U * 102U / 2U);
  EXPECT_EQ(count_subdivided(triangle, 0.0499), 102U * 103U / 2U);
  for (const double edge : {0.07, 0.3}) {
    const world::TriangleMesh mesh = soup(13, Vector3d(1, 2, 3));
    EXPECT_EQ(subdivided_vertices(mesh, edge, Vector3d(1, 2, 3)).size(),
              count_subdivided(mesh, edge));
  }
}

TEST(VertexDistance, IsRefusedBeforeAnythingGrowsWhereTheVerticesAreTooMany) {
  const world::World large(meshes::plane(100'000.0));  // some 8e12 vertices
  const std::vector<Vector3f> map(10, Vector3f(1, 1, 0));
  const VertexDistance found = distance_of(map, large, Pose::Identity(), 0.05);
  EXPECT_GT(found.vertices, 1'000'000'000'000U);
  EXPECT_THAT(found.refused.value_or(""),
              HasSubstr("the mesh subdivided to 5 cm has 8e+06 million vertices"));
  const Json json = to_json(found);
  EXPECT_EQ(json["refused"], found.refused.value());
  EXPECT_TRUE(json["rmse_m"].is_null());
  // the limit itself is allowed
  const world::World small(meshes::plane(0.9));
  const MortonOrder order = morton_order(map, kTwoThreads);
  const auto with = [&](std::uint64_t most) {
    const auto scores = score_points(map, order, Pose::Identity(), small, kTwoThreads);
    return SubdividedMesh(small, 0.05, most)
        .distance_of(map, order, scores, Pose::Identity(), kTwoThreads)
        .refused.value_or("");
  };
  EXPECT_EQ(with(754), "");
  EXPECT_THAT(with(753),
              HasSubstr("0.000754 million vertices, more than the limit of 0.000753 million"));
}

TEST(VertexDistance, OfPointsThatAreNotFiniteIsLeftOutAndOfNoneIsNull) {
  const world::World world(meshes::plane(0.9));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const VertexDistance found = distance_of({Vector3f(nan, 0, 0), Vector3f(0.45F, 0.45F, 0.1F)},
                                           world, Pose::Identity(), 0.05);
  EXPECT_EQ(found.points, 1U);
  EXPECT_NEAR(found.rmse_m.value(), 0.1, 1e-7);
  EXPECT_TRUE(to_json(distance_of({}, world, Pose::Identity(), 0.05)).is_null());
}

}  // namespace
}  // namespace lidarena::evaluation
