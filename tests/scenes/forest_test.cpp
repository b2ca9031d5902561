// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/scenes/forest.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <map>

#include "lidarena/scenes/drawn_scene.hpp"
#include "lidarena/world/world.hpp"
#include "tests/world/shapes.hpp"

namespace lidarena::scenes {
namespace {

using Eigen::Vector3d;

ForestConfig small_forest() {
  ForestConfig config;
  config.size_m = 30;
  return config;
}

TEST(Forest, SameSeedGivesTheSameForestAndAnotherSeedAnother) {
  const world::WorldModel a = make_forest(small_forest(), 5), b = make_forest(small_forest(), 5);
  EXPECT_EQ(a.mesh.vertices, b.mesh.vertices);
  EXPECT_EQ(a.mesh.triangles, b.mesh.triangles);
  EXPECT_EQ(a.routes, b.routes);
  EXPECT_NE(a.mesh.vertices, make_forest(small_forest(), 6).mesh.vertices);
}

TEST(Forest, KeepsTheClosedRouteClearAndHasGroundBelow) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const world::WorldModel forest = make_forest(drawn_forest({}, seed), seed);
    const world::World world(forest.mesh, "forest");
    const std::vector<Vector3d>& route = forest.routes[0];
    EXPECT_EQ(route.front(), route.back());
    for (std::size_t i = 1; i < route.size(); ++i) {
      for (int k = 0; k < 4; ++k) {
        const Vector3d p = route[i - 1] + 0.25 * k * (route[i] - route[i - 1]);
        EXPECT_GE(world.closest_point(p).distance, 0.9) << seed << ": " << p.transpose();
        const world::Ray down{p, Eigen::Vector3f(0, 0, -1)};
        world::Hit hit;
        world.cast({&down, 1}, 10.0, {&hit, 1});
        EXPECT_TRUE(hit.valid());
        EXPECT_LT(hit.range, 4.0F);
      }
    }
  }
}

TEST(Forest, HasTrunksCrownsAndGroundInView) {
  const world::WorldModel forest = make_forest(ForestConfig{}, 1);
  const world::World world(forest.mesh, "forest");
  SequentialRandom random(3);
  std::map<std::string, int> seen;
  const int count = 20'000;
  for (int i = 0; i < count; ++i) {
    const auto& route = forest.routes[0];
    const world::Ray ray{route[static_cast<std::size_t>(i) % route.size()],
                         world::testing::random_direction(random).cast<float>()};
    world::Hit hit;
    world.cast({&ray, 1}, 40.0, {&hit, 1});
    if (hit.valid()) ++seen[world.material(hit.triangle).name];
  }
  EXPECT_GT(seen["soil"], count / 4);
  EXPECT_GT(seen["bark"], count / 50);
  EXPECT_GT(seen["leaf"], count / 50);
}

/// Of the surface around the route, few patches of 0.5 m are flat to 1 cm: in a house most are.
TEST(Forest, HasHardlyAPlane) {
  const world::WorldModel forest = make_forest(ForestConfig{}, 1);
  const world::World world(forest.mesh, "forest");
  int flat = 0, patches = 0;
  for (const Vector3d& p : forest.routes[0]) {
    const Vector3d below = p - 1.9 * Vector3d::UnitZ();
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    Vector3d mean = Vector3d::Zero();
    std::vector<Vector3d> points;
    for (int i = 0; i < 5; ++i) {
      for (int j = 0; j < 5; ++j) {
        const auto nearest = world.closest_point(below + Vector3d(0.125 * i, 0.125 * j, 0));
        points.push_back(nearest.point);
        mean += nearest.point / 25.0;
      }
    }
    for (const Vector3d& q : points) spread += (q - mean) * (q - mean).transpose() / 25.0;
    const double thickness =
        std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvalues()[0]);
    flat += thickness < 0.005 ? 1 : 0;
    ++patches;
  }
  EXPECT_LT(flat, patches / 4);
}

}  // namespace
}  // namespace lidarena::scenes
