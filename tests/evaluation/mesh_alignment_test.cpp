// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/map/mesh_alignment.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "flights.hpp"
#include "lidarena/base/angle.hpp"
#include "lidarena/evaluation/map/map_error.hpp"
#include "meshes.hpp"
#include "tests/evaluation/two_threads.hpp"

namespace lidarena::evaluation {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A furnished room of 8 x 6 x 3 m.
world::TriangleMesh room() {
  world::TriangleMesh mesh = meshes::box(Vector3d(4, 3, 1.5));
  mesh.append(meshes::box(Vector3d(0.6, 0.4, 0.5)), flights::level({1.5, 1.0, -1.0}));
  mesh.append(meshes::box(Vector3d(0.3, 0.9, 0.8)), flights::level({-2.0, -1.2, -0.7}));
  return mesh;
}

/// Points on `mesh` with uniform density and normal noise along the surface normal.
std::vector<Vector3d> points_on(const world::TriangleMesh& mesh, std::size_t count, double sigma) {
  SequentialRandom random(71);
  std::vector<double> until;
  double area = 0.0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    area += 0.5 * mesh.cross(t).norm();
    until.push_back(area);
  }
  std::vector<Vector3d> points;
  while (points.size() < count) {
    const double at = random.uniform(0.0, area);
    const auto t =
        static_cast<std::size_t>(std::lower_bound(until.begin(), until.end(), at) - until.begin());
    const auto& [a, b, c] = mesh.triangles[t];
    double u = random.uniform(), v = random.uniform();
    if (u + v > 1.0) {
      u = 1.0 - u;
      v = 1.0 - v;
    }
    const Vector3d& origin = mesh.vertices[a];
    points.push_back(origin + u * (mesh.vertices[b] - origin) + v * (mesh.vertices[c] - origin) +
                     sigma * random.normal() * mesh.cross(t).normalized());
  }
  return points;
}

std::vector<Vector3f> as_map(const std::vector<Vector3d>& points, const Pose& map_from_mesh) {
  std::vector<Vector3f> map;
  for (const Vector3d& p : points) map.push_back((map_from_mesh * p).cast<float>());
  return map;
}

double rmse(const std::vector<Vector3f>& map, const Pose& mesh_from_map,
            const world::World& world) {
  return map_error(map, mesh_from_map, world, kTwoThreads).distance_m.rmse;
}

TEST(MeshAlignment, AMapMovedByAKnownTransformIsBroughtBack) {
  const world::World world(room());
  const double sigma = 0.02;
  const std::vector<Vector3d> points = points_on(world.mesh(), 20000, sigma);
  for (const double size : {0.5, 1.0}) {
    const Pose moved = make_pose(so3::exp(size * 3.0 * kDegree * Vector3d(0.6, -0.5, 0.62)),
                                 size * Vector3d(0.2, -0.15, 0.1));
    const std::vector<Vector3f> map = as_map(points, moved);
    const MeshAlignment a = align_to_mesh(map, Pose::Identity(), world, kTwoThreads);
    ASSERT_TRUE(a.determined()) << a.refusal;
    EXPECT_EQ(a.fit.starts_agreeing, MeshAlignment::kStarts);
    EXPECT_THAT(a.fit.frozen, IsEmpty());
    // some 10 000 voxels with 2 cm of noise, a third of them for each axis: 0.4 mm; tolerance four
    // times that
    const Pose left = a.mesh_from_map * moved;
    EXPECT_LT(left.translation().norm(), 0.0016);
    EXPECT_LT(so3::angle(left.linear()), 0.0016 / 1.5);
    EXPECT_NEAR(rmse(map, a.mesh_from_map, world), sigma, 0.02 * sigma + 1e-4);
    EXPECT_NEAR(a.fit.turned_rad, size * 3.0 * kDegree, 0.001);
  }
}

TEST(MeshAlignment, AMapBentByTwentyCentimetersKeepsItsError) {
  // A hall of 40 m whose map is bent by 20 cm to either side: no rigid motion can undo that.
  const world::World world(meshes::box(Vector3d(20, 2, 1.5)));
  std::vector<Vector3d> points = points_on(world.mesh(), 30000, 0.01);
  for (Vector3d& p : points) p.y() += 0.2 * std::cos(2.0 * std::numbers::pi * p.x() / 40.0);
  const std::vector<Vector3f> map = as_map(points, Pose::Identity());
  const double before = rmse(map, Pose::Identity(), world);
  // half of the area are the two side walls: 20 cm / sqrt(2) there; elsewhere only noise
  EXPECT_GT(before, 0.08);
  const MeshAlignment a = align_to_mesh(map, Pose::Identity(), world, kTwoThreads);
  ASSERT_TRUE(a.determined()) << a.refusal;
  const double after = rmse(map, a.mesh_from_map, world);
  EXPECT_GT(after, 0.9 * before);
  EXPECT_LT(after, 1.25 * before);  // nor is only one half aligned with the mesh
  std::cout << "bent map: RMSE " << 100 * before << " cm before, " << 100 * after << " cm after\n";
}

TEST(MeshAlignment, AnEndlessCorridorLeavesItsDirectionAsItWas) {
  const world::World world(meshes::box(Vector3d(50, 1.2, 1.4)));
  std::vector<Vector3d> points;
  for (const Vector3d& p : points_on(world.mesh(), 30000, 0.01)) {
    if (std::abs(p.x()) < 15.0) points.push_back(p);  // no end wall is seen
  }
  const Pose moved = make_pose(so3::exp(Vector3d(0.01, 0.005, -0.01)), Vector3d(0.4, 0.1, -0.08));
  const std::vector<Vector3f> map = as_map(points, moved);
  const MeshAlignment a = align_to_mesh(map, Pose::Identity(), world, kTwoThreads);
  ASSERT_TRUE(a.determined()) << a.refusal;
  EXPECT_THAT(a.fit.frozen, ElementsAre(HasSubstr("translation along (1.00,")));
  EXPECT_LT(a.fit.eigenvalues[0], 1e-4);
  EXPECT_GT(a.fit.eigenvalues[1], 0.05);
  const Pose left = a.mesh_from_map * moved;
  EXPECT_NEAR(left.translation().x(), 0.4, 0.02);  // as in the start, except for the rotation
  EXPECT_LT(left.translation().tail<2>().norm(), 0.002);
  EXPECT_LT(so3::angle(left.linear()), 0.001);
}

TEST(MeshAlignment, OneFloorHoldsHeightRollAndPitchAlone) {
  const world::World world(meshes::plane(40.0));
  std::vector<Vector3d> points;
  for (const Vector3d& p : points_on(world.mesh(), 20000, 0.01)) {
    if (p.head<2>().norm() < 10.0) points.push_back(p);
  }
  const Pose moved = make_pose(so3::exp(Vector3d(0.02, -0.01, 0)), Vector3d(0, 0, 0.1));
  const MeshAlignment a =
      align_to_mesh(as_map(points, moved), Pose::Identity(), world, kTwoThreads);
  ASSERT_TRUE(a.determined()) << a.refusal;
  ASSERT_EQ(a.fit.frozen.size(), 3U);
  EXPECT_THAT(a.fit.frozen[0], HasSubstr("translation along"));
  EXPECT_THAT(a.fit.frozen[1], HasSubstr("translation along"));
  EXPECT_EQ(a.fit.frozen[2], "rotation about (0.00, 0.00, 1.00)");
  const Pose left = a.mesh_from_map * moved;
  EXPECT_LT((left.linear() * Vector3d::UnitZ() - Vector3d::UnitZ()).norm(), 0.001);
  EXPECT_LT(std::abs((left * Vector3d::Zero()).z()), 0.001);
}

TEST(MeshAlignment, AMapOfAnotherPlaceIsRefused) {
  const world::World world(meshes::box(Vector3d(4, 3, 1.5)));
  const std::vector<Vector3d> elsewhere = points_on(meshes::box(Vector3d(15, 11, 6)), 20000, 0.01);
  const MeshAlignment a =
      align_to_mesh(as_map(elsewhere, Pose::Identity()), Pose::Identity(), world, kTwoThreads);
  EXPECT_FALSE(a.determined());
  EXPECT_THAT(a.refusal, HasSubstr("% of the map's points lie within 20 cm"));
}

TEST(MeshAlignment, AHandfulOfPointsAndAnEmptyMapAreRefused) {
  const world::World world(room());
  EXPECT_THAT(align_to_mesh({}, Pose::Identity(), world, kTwoThreads).refusal,
              HasSubstr("only 0 voxels"));
  const std::vector<Vector3f> few(50, Vector3f(4, 0, 0));
  EXPECT_FALSE(align_to_mesh(few, Pose::Identity(), world, kTwoThreads).determined());
}

TEST(MeshAlignment, AFifthOfGhostsDoesNotPullTheMap) {
  const world::World world(room());
  std::vector<Vector3d> points = points_on(world.mesh(), 20000, 0.01);
  for (std::size_t i = 0; i < points.size(); i += 5) points[i] += Vector3d(0.3, 0.3, 0.2);
  const std::vector<Vector3f> map = as_map(points, flights::level({0.1, 0.05, -0.1}));
  const MeshAlignment a = align_to_mesh(map, Pose::Identity(), world, kTwoThreads);
  ASSERT_TRUE(a.determined()) << a.refusal;
  const Vector3d left = a.mesh_from_map.translation() + Vector3d(0.1, 0.05, -0.1);
  EXPECT_LT(left.norm(), 0.005);
}

TEST(MeshAlignment, IsTheSameBitsOnAnyNumberOfThreads) {
  const world::World world(room());
  const std::vector<Vector3f> map =
      as_map(points_on(world.mesh(), 10000, 0.02), flights::level({0.1, 0.05, -0.1}));
  const MeshAlignment one = align_to_mesh(map, Pose::Identity(), world, Parallel(1));
  const MeshAlignment three = align_to_mesh(map, Pose::Identity(), world, Parallel(3));
  EXPECT_EQ(one.mesh_from_map.matrix(), three.mesh_from_map.matrix());
  EXPECT_EQ(one.fit.eigenvalues, three.fit.eigenvalues);
}

}  // namespace
}  // namespace lidarena::evaluation
