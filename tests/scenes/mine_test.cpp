// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/scenes/mine.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "lidarena/base/error.hpp"
#include "lidarena/scenes/drawn_scene.hpp"
#include "lidarena/scenes/mine_field.hpp"
#include "lidarena/scenes/mine_plan.hpp"
#include "lidarena/scenes/surface_nets.hpp"
#include "lidarena/world/world.hpp"
#include "tests/world/mesh_topology.hpp"
#include "tests/world/shapes.hpp"

namespace lidarena::scenes {
namespace {

using Eigen::Vector3d;

/// Four galleries around one cell, with coarse triangles.
MineConfig small_mine() {
  MineConfig config;
  config.columns = config.rows = 2;
  config.voxel_size_m = 0.2;
  config.branches = 1.0;
  return config;
}

TEST(Mine, SameSeedGivesTheSameMineAndAnotherSeedAnother) {
  const world::WorldModel a = make_mine(small_mine(), 5), b = make_mine(small_mine(), 5);
  EXPECT_EQ(a.mesh.vertices, b.mesh.vertices);
  EXPECT_EQ(a.mesh.triangles, b.mesh.triangles);
  EXPECT_EQ(a.routes, b.routes);
  EXPECT_NE(a.mesh.vertices, make_mine(small_mine(), 6).mesh.vertices);
}

TEST(Mine, HasJunctionsWithTwoGalleriesOrMoreAndARouteThroughAllWithoutAReversal) {
  std::size_t dead_ends = 0, chambers = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const MinePlan plan = plan_mine(drawn_mine({}, seed), seed);
    std::vector<int> degree(plan.junctions.size(), 0);
    for (const Gallery& gallery : plan.galleries) ++degree[gallery.from], ++degree[gallery.to];
    EXPECT_GE(std::ranges::min(degree), 2) << seed;
    dead_ends += plan.dead_ends.size();
    chambers += plan.chambers.size() / 2;

    const std::vector<Vector3d> route = mine_route(plan);
    EXPECT_EQ(route.front(), route.back());
    for (std::size_t i = 0; i + 1 < route.size(); ++i) {
      const Vector3d before = i == 0 ? route[route.size() - 2] : route[i - 1];
      const Vector3d in = (route[i] - before).normalized(),
                     out = (route[i + 1] - route[i]).normalized();
      EXPECT_GT(in.dot(out), -0.9) << seed;
    }
    for (const Gallery& gallery : plan.galleries) {
      const Vector3d middle = 0.5 * (gallery.drift.from + gallery.drift.to);
      double nearest = 1e9;
      for (const Vector3d& p : route) nearest = std::min(nearest, (p - middle).head<2>().norm());
      EXPECT_LT(nearest, 1.6) << seed;
    }
  }
  EXPECT_GT(dead_ends, 100U);
  EXPECT_GT(chambers, 100U);
}

TEST(Mine, TheRockIsOneClosedManifold) {
  for (const std::uint64_t seed : {1U, 2U}) {
    const MineConfig config = small_mine();
    SparseField samples = MineField(plan_mine(config, seed), config, seed).sample();
    make_well_composed(samples);
    const world::testing::Topology found = world::testing::topology(surface_net(samples));
    EXPECT_EQ(found.open_edges, 0U);
    EXPECT_EQ(found.pinched_vertices, 0U);
    EXPECT_EQ(found.components, 1U);
    EXPECT_EQ(found.euler, 0);  // the four galleries are one loop
  }
}

TEST(Mine, KeepsTheRouteClearAndHasNoHoles) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const world::WorldModel mine = make_mine(drawn_mine({}, seed), seed);
    const world::World world(mine.mesh, "mine");
    SequentialRandom random(seed);
    std::vector<world::Ray> rays;
    const std::vector<Vector3d>& route = mine.routes[0];
    for (std::size_t i = 1; i < route.size(); ++i) {
      for (int k = 0; k < 4; ++k) {
        const Vector3d p = route[i - 1] + 0.25 * k * (route[i] - route[i - 1]);
        EXPECT_GE(world.closest_point(p).distance, 0.6) << seed << ": " << p.transpose();
        for (int ray = 0; ray < 50; ++ray)
          rays.push_back({p, world::testing::random_direction(random).cast<float>()});
      }
    }
    std::vector<world::Hit> hits(rays.size());
    world.cast(rays, 1000, hits);
    EXPECT_TRUE(std::ranges::all_of(hits, [](const world::Hit& hit) { return hit.valid(); }));
  }
}

TEST(Mine, GalleriesAreTwoToFourMetersWide) {
  MineConfig config;
  config.supports = 0.0;
  config.branches = 0.0;
  const world::WorldModel mine = make_mine(config, 1);
  const world::World world(mine.mesh, "mine");
  for (const Gallery& gallery : plan_mine(config, 1).galleries) {
    const Vector3d step = gallery.drift.to - gallery.drift.from;
    const Eigen::Vector3f side = Vector3d::UnitZ().cross(step).normalized().cast<float>();
    for (double share = 0.25; share <= 0.75; share += 0.05) {
      const Vector3d p = gallery.drift.from + share * step + 1.3 * Vector3d::UnitZ();
      const std::array<world::Ray, 2> rays{world::Ray{p, side}, world::Ray{p, -side}};
      std::array<world::Hit, 2> hits;
      world.cast(rays, 100, hits);
      EXPECT_GE(hits[0].range + hits[1].range, 2.0F);
      EXPECT_LE(hits[0].range + hits[1].range, 4.0F);
    }
  }
}

TEST(Mine, RefusesWidthsWithoutRoomForTheRoughness) {
  MineConfig config;
  config.width_min_m = 3.0;
  config.width_max_m = 3.2;
  EXPECT_THROW(make_mine(config, 1), InputError);
}

}  // namespace
}  // namespace lidarena::scenes
