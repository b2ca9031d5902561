// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/scenes/office.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "lidarena/scenes/drawn_scene.hpp"
#include "lidarena/world/world.hpp"
#include "tests/world/shapes.hpp"

namespace lidarena::scenes {
namespace {

using Eigen::Vector3d;

TEST(Office, SameSeedGivesTheSameOfficeAndAnotherSeedAnother) {
  const world::WorldModel a = make_office({}, 5), b = make_office({}, 5);
  EXPECT_EQ(a.mesh.vertices, b.mesh.vertices);
  EXPECT_EQ(a.mesh.triangles, b.mesh.triangles);
  EXPECT_EQ(a.routes, b.routes);
  EXPECT_NE(a.mesh.vertices, make_office({}, 6).mesh.vertices);
}

TEST(Office, KeepsTheClosedRouteClearAndHasNoHoles) {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    const world::WorldModel office = make_office(drawn_office({}, seed), seed);
    const world::World world(office.mesh, "office");
    const std::vector<Vector3d>& route = office.routes[0];
    EXPECT_EQ(route.front(), route.back());
    SequentialRandom random(seed);
    std::vector<world::Ray> rays;
    for (std::size_t i = 1; i < route.size(); ++i) {
      for (int k = 0; k < 4; ++k) {
        const Vector3d p = route[i - 1] + 0.25 * k * (route[i] - route[i - 1]);
        EXPECT_GE(world.closest_point(p).distance, 0.7) << seed << ": " << p.transpose();
        for (int ray = 0; ray < 40; ++ray)
          rays.push_back({p, world::testing::random_direction(random).cast<float>()});
      }
    }
    std::vector<world::Hit> hits(rays.size());
    world.cast(rays, 1000, hits);
    std::map<std::string, int> seen;
    for (const world::Hit& hit : hits) {
      ASSERT_TRUE(hit.valid());
      ++seen[world.material(hit.triangle).name];
    }
    EXPECT_GT(seen["glass"], static_cast<int>(hits.size() / 20));
  }
}

/// Along a corridor the walls repeat from office to office: what differs are doors and furniture.
TEST(Office, HasEqualWallsFromOfficeToOffice) {
  const OfficeConfig config;
  const world::WorldModel office = make_office(config, 1);
  const world::World world(office.mesh, "office");
  SequentialRandom random(2);
  for (int i = 0; i < 300; ++i) {
    const double y = random.uniform(-0.4, 0.4) - 0.5 * config.corridor_m;
    const Vector3d start(config.office_width_m * 3.0 + random.uniform(0.0, 1.5), y, 2.4);
    const Eigen::Vector3f up(0.0F, -0.9F, 0.43589F);  // to the wall above the doors
    const std::array<world::Ray, 2> rays{
        world::Ray{start, up}, world::Ray{start + Vector3d(config.office_width_m, 0, 0), up}};
    std::array<world::Hit, 2> hits;
    world.cast(rays, 100, hits);
    EXPECT_NEAR(hits[0].range, hits[1].range, 1e-4F);
  }
}

}  // namespace
}  // namespace lidarena::scenes
