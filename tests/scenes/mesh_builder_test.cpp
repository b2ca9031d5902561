// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/scenes/mesh_builder.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/world/shapes.hpp"

namespace lidarena::scenes {
namespace {

using world::testing::signed_volume;

constexpr double kPi = std::numbers::pi;

TEST(MeshBuilder, ClosedShapesHaveTheirVolumeWithNormalsOutward) {
  EXPECT_NEAR(signed_volume(shape::box({1, 2, 3}, {2, 4, 6})), 6, 1e-12);
  // A prism with n sides has n / (2 pi) sin(2 pi / n) of the cylinder's area.
  const double share = 64 / (2 * kPi) * std::sin(2 * kPi / 64);
  EXPECT_NEAR(signed_volume(shape::cylinder(0.5, 2, 64, 3)), share * kPi * 0.25 * 2, 1e-12);
  EXPECT_NEAR(signed_volume(shape::bar({{0, 0, 0}, {0, 0, 1}, {0, 0, 3}}, 0.5, 64)),
              share * kPi * 0.25 * 3, 1e-12);
  // With facets of d = 2 pi / 96 rad the volume is about d^2 / 4 below that of the ball.
  EXPECT_NEAR(signed_volume(shape::ball(1, 96)), 4 * kPi / 3, 4 * kPi / 3 * 0.005);
}

TEST(MeshBuilder, ABoxKeepsItsSizeWhenItsEdgesAreRounded) {
  const world::TriangleMesh mesh = shape::rounded_box({2, 1, 0.5}, 0.1, 16);
  EXPECT_TRUE(mesh.bounds().min().isApprox(Eigen::Vector3d(-1, -0.5, 0), 1e-12));
  EXPECT_TRUE(mesh.bounds().max().isApprox(Eigen::Vector3d(1, 0.5, 0.5), 1e-12));
  // Minkowski sum of the core box with a ball: Steiner's formula.
  const double a = 1.8;
  const double b = 0.8;
  const double c = 0.3;
  const double r = 0.1;
  const double volume = a * b * c + 2 * r * (a * b + b * c + c * a) + kPi * r * r * (a + b + c) +
                        4 * kPi / 3 * r * r * r;
  EXPECT_NEAR(signed_volume(mesh), volume, 0.005 * volume);
}

TEST(MeshBuilder, APuffedBoxIsLargerByTheMeanOfItsBulge) {
  const double flat = signed_volume(shape::rounded_box({1, 1, 1}, 0, 32));
  const double puffed = signed_volume(shape::rounded_box({1, 1, 1}, 0, 32, 0.1));
  EXPECT_NEAR(flat, 1, 1e-12);
  // The mean of (1 - x^2)(1 - y^2) over a face is 4 / 9.
  EXPECT_NEAR(puffed - flat, 6 * 0.1 * 4 / 9, 0.001);
}

TEST(MeshBuilder, ALathedSphereHasNoDegenerateTriangles) {
  const world::TriangleMesh mesh = shape::ball(1, 24);
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3d u = mesh.vertices[b] - mesh.vertices[a];
    EXPECT_GT(u.cross(mesh.vertices[c] - mesh.vertices[a]).norm(), 1e-6);
  }
}

}  // namespace
}  // namespace lidarena::scenes
