// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/world/triangle_mesh.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "lidarena/base/error.hpp"
#include "tests/world/complaints.hpp"
#include "tests/world/shapes.hpp"

namespace lidarena::world {
namespace {

using Eigen::Vector3d;
using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(TriangleMesh, BoxHasItsSurfaceVolumeAndBounds) {
  const TriangleMesh box = testing::box_mesh({1, 2, 3}, {2, 4, 6});
  EXPECT_DOUBLE_EQ(box.area(), 2 * (1 * 2 + 2 * 3 + 3 * 1));
  EXPECT_DOUBLE_EQ(testing::signed_volume(box), 6.0);
  EXPECT_EQ(box.bounds().min(), Vector3d(1, 2, 3));
  EXPECT_EQ(box.bounds().max(), Vector3d(2, 4, 6));
}

TEST(TriangleMesh, BoundsIgnoreVerticesNoTriangleUses) {
  TriangleMesh box = testing::box_mesh({0, 0, 0}, {1, 1, 1});
  box.vertices.emplace_back(100, 100, 100);
  EXPECT_EQ(box.bounds().max(), Vector3d(1, 1, 1));
}

TEST(TriangleMesh, AppendScalesFirstThenPlaces) {
  TriangleMesh mesh = testing::box_mesh({0, 0, 0}, {1, 1, 1});
  const Pose quarter_turn_about_z = make_pose(
      Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitZ())), {10, 0, 0});
  mesh.append(testing::box_mesh({0, 0, 0}, {1, 1, 1}), quarter_turn_about_z, {2, 3, 4});
  ASSERT_EQ(mesh.triangles.size(), 24U);
  // x in [0, 2] becomes y in [0, 2]; y in [0, 3] becomes x in 10 - [0, 3].
  EXPECT_TRUE(mesh.bounds().min().isApprox(Vector3d(0, 0, 0), 1e-12));
  EXPECT_TRUE(mesh.bounds().max().isApprox(Vector3d(10, 2, 4), 1e-12));
  EXPECT_NEAR(testing::signed_volume(mesh), 1 + 24, 1e-12);
}

TEST(TriangleMesh, MirroringKeepsNormalsOutward) {
  TriangleMesh mesh;
  mesh.append(testing::box_mesh({0, 0, 0}, {1, 1, 1}), Pose::Identity(), {-1, 2, 1});
  EXPECT_DOUBLE_EQ(testing::signed_volume(mesh), 2.0);
}

TEST(Materials, StayWithTheirTrianglesWhenMeshesAreJoined) {
  TriangleMesh plain = testing::box_mesh({0, 0, 0}, {1, 1, 1});
  TriangleMesh wood = plain, glass = plain;
  wood.paint(materials::kWood);
  glass.paint(materials::kGlass);
  TriangleMesh room;
  room.append(plain);
  EXPECT_TRUE(room.material_ids.empty());  // not stored when all materials are the default
  EXPECT_EQ(room.material(3), Material{});
  room.append(wood);
  room.append(glass);
  room.append(plain);
  room.append(wood);
  ASSERT_EQ(room.material_ids.size(), 60U);
  EXPECT_EQ(room.palette.size(), 3U);
  const Material* expected[] = {nullptr, &materials::kWood, &materials::kGlass, nullptr,
                                &materials::kWood};
  for (std::size_t i = 0; i < 60; ++i) {
    EXPECT_EQ(room.material(i), expected[i / 12] ? *expected[i / 12] : Material{}) << i;
  }
  room.triangles[12] = {0, 0, 1};  // degenerate: removed together with its material
  clean_mesh(room, "room");
  EXPECT_EQ(room.material_ids.size(), 59U);
  EXPECT_EQ(room.material(22), materials::kWood);
  EXPECT_EQ(room.material(23), materials::kGlass);
}

TEST(Materials, ThatDoNotFitTheTrianglesAreRefused) {
  TriangleMesh mesh = testing::box_mesh({0, 0, 0}, {1, 1, 1});
  mesh.paint(materials::kWood);
  mesh.material_ids.back() = 1;
  EXPECT_THAT(testing::input_error_of([&] { clean_mesh(mesh, "box"); }),
              HasSubstr("material index 1, number of materials: 1"));
  mesh.material_ids.pop_back();
  EXPECT_THAT(testing::input_error_of([&] { clean_mesh(mesh, "box"); }),
              HasSubstr("11 materials for 12 triangles"));
}

TEST(Materials, ADiffuseSurfaceFollowsLambertAndAMirrorIsSeenHeadOnAlone) {
  for (const double cosine : {0.0, 0.3, 1.0}) {
    EXPECT_DOUBLE_EQ(backscatter({"gray", 0.4, 0.0}, cosine), 0.4 * cosine);
  }
  const double head_on = backscatter(materials::kMirror, 1.0);
  EXPECT_GT(head_on, 10.0);
  EXPECT_LT(backscatter(materials::kMirror, std::cos(0.35)), 0.01);  // at 20 deg incidence
  // Energy is conserved: the integral of the lobe over the half space, by the midpoint rule, is 1.
  constexpr int kSteps = 20000;
  double sum = 0.0;
  const Material lobe{"lobe", 1.0, 1.0};
  for (int i = 0; i < kSteps; ++i) {
    const double to_mirror = 0.5 * std::numbers::pi * (i + 0.5) / kSteps;  // twice the incidence
    const double radiance =
        backscatter(lobe, std::cos(0.5 * to_mirror)) / std::cos(0.5 * to_mirror);
    sum += radiance * std::sin(to_mirror) * std::cos(to_mirror) * 2.0 * std::numbers::pi *
           (0.5 * std::numbers::pi / kSteps) / std::numbers::pi;
  }
  EXPECT_NEAR(sum, 1.0, 1e-3);
}

TEST(CleanMesh, RefusesAMeshWithoutFaces) {
  TriangleMesh mesh;
  mesh.vertices.emplace_back(0, 0, 0);
  EXPECT_THAT(testing::input_error_of([&] { clean_mesh(mesh, "points.ply"); }),
              AllOf(HasSubstr("points.ply"), HasSubstr("no faces")));
}

TEST(CleanMesh, RefusesAnIndexOutOfRange) {
  TriangleMesh mesh = testing::box_mesh({0, 0, 0}, {1, 1, 1});
  mesh.triangles[5][1] = 8;
  EXPECT_THAT(testing::input_error_of([&] { clean_mesh(mesh, "box"); }), HasSubstr("triangle 5"));
}

TEST(CleanMesh, RefusesAVertexThatIsNotFinite) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::infinity()}) {
    TriangleMesh mesh = testing::box_mesh({0, 0, 0}, {1, 1, 1});
    mesh.vertices[3].y() = bad;
    EXPECT_THAT(testing::input_error_of([&] { clean_mesh(mesh, "box"); }), HasSubstr("vertex 3"));
  }
}

TEST(CleanMesh, DropsTrianglesWithoutAreaAndCountsThem) {
  TriangleMesh mesh = testing::box_mesh({0, 0, 0}, {1, 1, 1});
  mesh.triangles.push_back({0, 0, 1});  // a corner twice
  mesh.vertices.emplace_back(0.3, 0.3, 0.3);
  mesh.triangles.push_back({0, 7, 8});  // three collinear corners
  EXPECT_EQ(clean_mesh(mesh, "box"), 2U);
  EXPECT_EQ(mesh.triangles.size(), 12U);
}

TEST(CleanMesh, RefusesAMeshOfDegenerateTrianglesOnly) {
  TriangleMesh mesh = testing::box_mesh({0, 0, 0}, {1, 1, 1});
  mesh.triangles = {{0, 0, 1}};
  EXPECT_THAT(testing::input_error_of([&] { clean_mesh(mesh, "box"); }), HasSubstr("degenerate"));
}

TEST(CleanMesh, KeepsMicrometerTrianglesNearTheOrigin) {
  TriangleMesh mesh = testing::box_mesh({0, 0, 0}, {1e-6, 1e-6, 1e-6});
  EXPECT_EQ(clean_mesh(mesh, "speck"), 0U);
}

TEST(MergeVertices, MakesASoupOfABoxIntoEightCorners) {
  const TriangleMesh box = testing::box_mesh({-0.5, 0, 0}, {0.5, 1, 1});
  TriangleMesh soup;
  for (const Triangle& triangle : box.triangles) {
    const auto first = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t corner : triangle) soup.vertices.push_back(box.vertices[corner]);
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  soup.vertices[0].y() = -0.0;  // equal to +0
  merge_vertices(soup);
  EXPECT_EQ(soup.vertices.size(), 8U);
  EXPECT_DOUBLE_EQ(soup.area(), 6.0);
  EXPECT_DOUBLE_EQ(testing::signed_volume(soup), 1.0);
}

TEST(ClosestPointOnTriangle, FindsFaceEdgeAndCorner) {
  const Vector3d a(0, 0, 0), b(4, 0, 0), c(0, 4, 0);
  EXPECT_EQ(closest_point_on_triangle({1, 1, 7}, a, b, c), Vector3d(1, 1, 0));
  EXPECT_EQ(closest_point_on_triangle({1, -3, 2}, a, b, c), Vector3d(1, 0, 0));
  EXPECT_EQ(closest_point_on_triangle({3, 3, -1}, a, b, c), Vector3d(2, 2, 0));
  EXPECT_EQ(closest_point_on_triangle({-1, -1, 1}, a, b, c), a);
  EXPECT_EQ(closest_point_on_triangle({9, -1, 1}, a, b, c), b);
  EXPECT_EQ(closest_point_on_triangle({-1, 9, 1}, a, b, c), c);
}

TEST(ClosestPointOnTriangle, NoSampleOfTheTriangleIsNearer) {
  SequentialRandom random(7);
  constexpr int kSteps = 60;
  for (int trial = 0; trial < 300; ++trial) {
    const Vector3d a = testing::random_point(random, 1), b = testing::random_point(random, 1),
                   c = testing::random_point(random, 1), p = testing::random_point(random, 2);
    double sampled = std::numeric_limits<double>::infinity();
    for (int i = 0; i <= kSteps; ++i) {
      for (int j = 0; i + j <= kSteps; ++j) {
        const Vector3d q = a + (b - a) * i / kSteps + (c - a) * j / kSteps;
        sampled = std::min(sampled, (p - q).norm());
      }
    }
    const double exact = (p - closest_point_on_triangle(p, a, b, c)).norm();
    // Every point of the triangle has a sample within one grid cell.
    const double spacing = std::max((b - a).norm(), (c - a).norm()) * 2 / kSteps;
    EXPECT_LE(exact, sampled + 1e-12);
    EXPECT_GE(exact, sampled - spacing);
  }
}

}  // namespace
}  // namespace lidarena::world
