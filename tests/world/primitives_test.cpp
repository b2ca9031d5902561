// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/world/primitives.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "tests/world/shapes.hpp"

namespace lidarena::world {
namespace {

using Eigen::Vector3d;

// Area of the regular polygon with kSectors corners on the unit circle (that of the circle is pi).
const double kPolygon = 0.5 * kSectors * std::sin(2 * std::numbers::pi / kSectors);

// Volume of the solid with `kSectors` sides through the points (r, z): a stack of frusta.
double stacked_volume(const std::vector<std::pair<double, double>>& profile) {
  double volume = 0.0;
  for (std::size_t i = 1; i < profile.size(); ++i) {
    const auto [r0, z0] = profile[i - 1];
    const auto [r1, z1] = profile[i];
    volume += kPolygon * (z1 - z0) / 3.0 * (r0 * r0 + r0 * r1 + r1 * r1);
  }
  return volume;
}

double unit_sphere_volume() {
  std::vector<std::pair<double, double>> profile;
  for (int i = 0; i <= kStacks; ++i) {
    const double elevation = std::numbers::pi * (double(i) / kStacks - 0.5);
    profile.emplace_back(std::cos(elevation), std::sin(elevation));
  }
  return stacked_volume(profile);
}

void expect_half_sizes(const TriangleMesh& mesh, const Vector3d& half) {
  EXPECT_TRUE(mesh.bounds().min().isApprox(-half, 1e-12)) << mesh.bounds().min().transpose();
  EXPECT_TRUE(mesh.bounds().max().isApprox(half, 1e-12)) << mesh.bounds().max().transpose();
}

// Every edge belongs to two triangles that traverse it in opposite directions.
void expect_closed(const TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) ++edges[{t[i], t[(i + 1) % 3]}];
  }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_TRUE(edges.contains({edge.second, edge.first}));
  }
}

TEST(Primitives, ABoxHasItsSizeAndVolume) {
  const TriangleMesh box = box_shape({1, 2, 3});
  expect_half_sizes(box, {0.5, 1, 1.5});
  expect_closed(box);
  EXPECT_DOUBLE_EQ(testing::signed_volume(box), 6.0);
}

TEST(Primitives, ACylinderHasThePrismsVolumeAndItsRadius) {
  const TriangleMesh cylinder = cylinder_shape(0.5, 3.0);
  expect_half_sizes(cylinder, {0.5, 0.5, 1.5});
  expect_closed(cylinder);
  EXPECT_NEAR(testing::signed_volume(cylinder), kPolygon * 0.25 * 3.0, 1e-12);
  EXPECT_NEAR(testing::signed_volume(cylinder) / (std::numbers::pi * 0.25 * 3.0), 1.0, 0.002);
}

TEST(Primitives, ASphereHasTheVolumeOfItsFrusta) {
  const TriangleMesh sphere = sphere_shape(2.0);
  expect_half_sizes(sphere, {2, 2, 2});
  expect_closed(sphere);
  EXPECT_NEAR(testing::signed_volume(sphere), 8.0 * unit_sphere_volume(), 1e-12);
  for (const Vector3d& v : sphere.vertices) EXPECT_NEAR(v.norm(), 2.0, 1e-12);
}

TEST(Primitives, AnEllipsoidIsAStretchedSphere) {
  const TriangleMesh ellipsoid = ellipsoid_shape({1, 2, 3});
  expect_half_sizes(ellipsoid, {1, 2, 3});
  expect_closed(ellipsoid);
  EXPECT_NEAR(testing::signed_volume(ellipsoid), 6.0 * unit_sphere_volume(), 1e-12);
}

TEST(Primitives, ACapsuleIsACylinderBetweenHalfSpheres) {
  const TriangleMesh capsule = capsule_shape(0.5, 2.0);
  expect_half_sizes(capsule, {0.5, 0.5, 1.5});
  expect_closed(capsule);
  EXPECT_NEAR(testing::signed_volume(capsule), 0.125 * unit_sphere_volume() + kPolygon * 0.25 * 2.0,
              1e-12);
}

TEST(Primitives, APlaneLiesAcrossItsNormal) {
  const TriangleMesh floor = plane_shape({0, 0, 1}, {4, 6});
  expect_half_sizes(floor, {2, 3, 0});
  EXPECT_DOUBLE_EQ(floor.area(), 24.0);
  for (const Vector3d& normal : {Vector3d(1, 0, 0), Vector3d(0, 0, -1), Vector3d(1, 2, -2)}) {
    const TriangleMesh plane = plane_shape(normal, {4, 6});
    EXPECT_NEAR(plane.area(), 24.0, 1e-12);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_TRUE(plane.cross(i).normalized().isApprox(normal.normalized(), 1e-12));
    }
  }
}

}  // namespace
}  // namespace lidarena::world
