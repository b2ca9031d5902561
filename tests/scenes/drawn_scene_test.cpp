// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/scenes/drawn_scene.hpp"

#include <gtest/gtest.h>

#include <array>
#include <set>

#include "lidarena/scenes/house_furnish.hpp"
#include "lidarena/scenes/house_plan.hpp"
#include "lidarena/world/world.hpp"

namespace lidarena::scenes {
namespace {

constexpr std::uint64_t kSeeds = 12;

TEST(DrawnScene, SeedsGiveDifferentHousesWithinTheirLimits) {
  std::set<double> widths;
  bool has_low = false, has_high = false, has_symmetric = false, has_other = false;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const HouseConfig house = drawn_house({}, seed);
    EXPECT_EQ(house.width_m, drawn_house({}, seed).width_m);
    EXPECT_NO_THROW(make_house(house, seed)) << seed;
    widths.insert(house.width_m);
    (house.high_rooms ? has_high : has_low) = true;
    (house.symmetric ? has_symmetric : has_other) = true;
  }
  EXPECT_EQ(widths.size(), kSeeds);
  EXPECT_TRUE(has_low && has_high && has_symmetric && has_other);
}

TEST(DrawnScene, AHouseWithoutHighRoomsHasOneStoryAndNoGallery) {
  HouseConfig config;
  config.detail = 0.3;
  config.high_rooms = false;
  const HousePlan plan = plan_house(config, 3);
  for (const Room& room : plan.rooms) EXPECT_EQ(room.height, config.story_height_m);
  for (const Opening& window : plan.windows) EXPECT_LT(window.head, config.story_height_m);
  for (const Eigen::Vector3d& point : plan.route) EXPECT_LE(point.z(), config.story_height_m - 0.6);
  for (const PlacedObject& object : furnish_house(plan, config, 3)) {
    EXPECT_NE(object.kind, "gallery");
    EXPECT_LE(object.box.max().z(), config.story_height_m + 1e-9) << object.kind;
  }
}

TEST(DrawnScene, FurnishingIsTheShareOfTheFurniture) {
  HouseConfig config;
  config.detail = 0.3;
  config.high_rooms = false;
  const HousePlan plan = plan_house(config, 3);
  const auto pieces = [&](double share) {
    config.furnishing = share;
    return furnish_house(plan, config, 3).size();
  };
  EXPECT_EQ(pieces(0.0), 0U);
  EXPECT_GT(pieces(0.5), 0U);
  EXPECT_LT(pieces(0.5), pieces(1.0));
}

TEST(DrawnScene, RoutesKeepClearInDrawnWorlds) {
  constexpr double kClear = 0.35;  // m; flights need 0.3 m
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    CaveConfig cave = drawn_cave({}, seed);
    cave.voxel_size_m = 0.25;
    for (world::WorldModel& model :
         std::array{make_house(drawn_house({}, seed), seed), make_cave(cave, seed)}) {
      const auto route = drawn_route(model.routes.front(), seed);
      const world::World world(std::move(model.mesh), "drawn");
      for (std::size_t i = 1; i < route.size(); ++i) {
        const int steps = static_cast<int>((route[i] - route[i - 1]).norm() / 0.1) + 1;
        for (int k = 0; k < steps; ++k) {
          const Eigen::Vector3d p = route[i - 1] + (route[i] - route[i - 1]) * k / steps;
          EXPECT_GT(world.closest_point(p).distance, kClear)
              << model.name << " " << seed << " at " << p.transpose();
        }
      }
    }
  }
}

TEST(DrawnScene, AClosedRouteBeginsElsewhereAndStaysTheSame) {
  std::vector<Eigen::Vector3d> route;
  for (int i = 0; i < 10; ++i) route.emplace_back(i, i * i, 0);
  route.push_back(route.front());
  std::set<double> starts;
  int backwards = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const auto drawn = drawn_route(route, seed);
    ASSERT_EQ(drawn.size(), route.size());
    EXPECT_EQ(drawn.front(), drawn.back());
    starts.insert(drawn.front().x());
    const auto at = static_cast<std::size_t>(drawn.front().x());
    const bool forwards = drawn[1] == route[(at + 1) % 10];
    EXPECT_EQ(drawn[1], route[(at + (forwards ? 1 : 9)) % 10]);
    EXPECT_EQ(drawn[9], route[(at + (forwards ? 9 : 1)) % 10]);
    backwards += forwards ? 0 : 1;
  }
  EXPECT_GT(starts.size(), 7U);
  EXPECT_GT(backwards, 8);
  EXPECT_LT(backwards, 32);
}

}  // namespace
}  // namespace lidarena::scenes
