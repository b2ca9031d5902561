// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/people.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/world/shapes.hpp"

namespace lidarena::flight {
namespace {

using Eigen::Vector3d;

/// Straight along x at a height of 1.2 m.
class StraightFlight : public Flight {
 public:
  Motion at(Time t) const override {
    Motion motion;
    motion.world_from_body.translation() = Vector3d(-8.0 + 0.8 * to_seconds(t), 0, 1.2);
    return motion;
  }
  Time duration() const override { return std::chrono::seconds(20); }
};

/// A room with a pillar.
world::World pillared_room() {
  world::TriangleMesh mesh = world::testing::box_mesh({-10, -5, 0}, {10, 5, 3});
  mesh.append(world::testing::box_mesh({-1, 2, 0}, {1, 4, 3}));
  return world::World(mesh, "room", world::RayCaster::kBvh);
}

TEST(People, WalkOnFreeFloorBesideTheFlight) {
  const world::World room = pillared_room();
  const StraightFlight flight;
  const auto people = draw_people(room, flight, 12, 7);
  ASSERT_EQ(people.size(), 12U);
  std::size_t walking = 0;
  for (const world::MoverConfig& person : people) {
    EXPECT_NO_THROW(world::check_mover(person, "people"));
    walking += person.path.size() - 1;
    for (int i = 0; i < 100; ++i) {
      const Vector3d place = world::mover_pose(person, from_seconds(0.3 * i)).translation();
      EXPECT_NEAR(place.z(), 0.0, 1e-6);
      // Checked are places 0.3 m apart: between them the free space may be 0.02 m narrower.
      EXPECT_GE(room.closest_point(place + Vector3d(0, 0, 0.9)).distance, 0.29);
      const double along = std::clamp(place.x(), -8.0, 8.0);
      EXPECT_GE((place - Vector3d(along, 0, 0)).norm(), kPeopleClearance - 0.02);
    }
  }
  EXPECT_GE(walking, 11U);
}

TEST(People, AreThoseOfTheirSeed) {
  const world::World room = pillared_room();
  const StraightFlight flight;
  const auto places_of = [&](std::uint64_t seed) {
    std::vector<Vector3d> places;
    for (const auto& person : draw_people(room, flight, 5, seed)) places.push_back(person.path[0]);
    return places;
  };
  EXPECT_EQ(places_of(7), places_of(7));
  EXPECT_NE(places_of(7), places_of(8));
}

TEST(People, AreFewerWhereThereIsNoFloor) {
  const world::World shaft(world::testing::box_mesh({-8.5, -0.8, 0}, {8.5, 0.8, 3}), "shaft",
                           world::RayCaster::kBvh);
  EXPECT_TRUE(draw_people(shaft, StraightFlight(), 3, 1).empty());
}

}  // namespace
}  // namespace lidarena::flight
