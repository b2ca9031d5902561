// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/scenes/hall.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "lidarena/base/error.hpp"
#include "lidarena/scenes/drawn_scene.hpp"
#include "lidarena/world/world.hpp"
#include "tests/world/shapes.hpp"

namespace lidarena::scenes {
namespace {

using Eigen::Vector3d;

TEST(Hall, SameSeedGivesTheSameHallAndAnotherSeedAnother) {
  const world::WorldModel a = make_hall({}, 5), b = make_hall({}, 5);
  EXPECT_EQ(a.mesh.vertices, b.mesh.vertices);
  EXPECT_EQ(a.mesh.triangles, b.mesh.triangles);
  EXPECT_EQ(a.routes, b.routes);
  EXPECT_NE(a.mesh.vertices, make_hall({}, 6).mesh.vertices);
}

TEST(Hall, KeepsTheClosedRouteClearAndHasNoHoles) {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    const HallConfig config = drawn_hall({}, seed);
    const world::WorldModel hall = make_hall(config, seed);
    const world::World world(hall.mesh, "hall");
    const std::vector<Vector3d>& route = hall.routes[0];
    EXPECT_EQ(route.front(), route.back());
    SequentialRandom random(seed);
    std::vector<world::Ray> rays;
    for (std::size_t i = 1; i < route.size(); ++i) {
      const Vector3d before = i == 1 ? route[route.size() - 2] : route[i - 2];
      EXPECT_GT((route[i - 1] - before).normalized().dot((route[i] - route[i - 1]).normalized()),
                -0.5);
      for (int k = 0; k < 4; ++k) {
        const Vector3d p = route[i - 1] + 0.25 * k * (route[i] - route[i - 1]);
        EXPECT_GE(world.closest_point(p).distance, 1.0) << seed << ": " << p.transpose();
        for (int ray = 0; ray < 20; ++ray)
          rays.push_back({p, world::testing::random_direction(random).cast<float>()});
      }
    }
    std::vector<world::Hit> hits(rays.size());
    world.cast(rays, 1000, hits);
    EXPECT_TRUE(std::ranges::all_of(hits, [](const world::Hit& hit) { return hit.valid(); }));
  }
}

TEST(Hall, IsFilledAsAsked) {
  HallConfig config;
  config.filling = 0.0;
  const std::size_t empty = make_hall(config, 1).mesh.triangles.size();
  config.filling = 1.0;
  EXPECT_GT(make_hall(config, 1).mesh.triangles.size(), 3 * empty);
}

TEST(Hall, RefusesAnEvenNumberOfRowsAndRacksThatReachTheRoof) {
  HallConfig config;
  config.rows = 4;
  EXPECT_THROW(make_hall(config, 1), InputError);
  config.rows = 5;
  config.levels = 5;
  config.height_m = 6;
  EXPECT_THROW(make_hall(config, 1), InputError);
}

}  // namespace
}  // namespace lidarena::scenes
