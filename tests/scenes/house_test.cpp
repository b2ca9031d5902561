// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/scenes/house.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numbers>
#include <set>

#include "lidarena/scenes/furnisher.hpp"
#include "lidarena/scenes/house_furnish.hpp"
#include "lidarena/scenes/house_plan.hpp"
#include "lidarena/scenes/house_shell.hpp"
#include "lidarena/scenes/load_world.hpp"
#include "lidarena/world/world.hpp"
#include "tests/world/shapes.hpp"

namespace lidarena::scenes {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// The default house with coarse curved parts: same plan and positions, generated quickly.
HouseConfig coarse_house() {
  HouseConfig config;
  config.detail = 0.3;
  return config;
}

/// The smallest and the largest house that the parameter ranges allow.
std::vector<HouseConfig> extreme_houses() {
  std::vector<HouseConfig> houses;
  for (const bool large : {false, true}) {
    HouseConfig config = coarse_house();
    config.width_m = large ? 24 : 15;
    config.depth_m = large ? 16 : 10;
    config.story_height_m = large ? 3.2 : 2.5;
    config.wall_thickness_m = large ? 0.1 : 0.2;
    config.door_width_m = large ? 0.9 : 0.86;
    config.door_height_m = large ? 2.2 : 2.0;
    config.variation_m = 0.3;
    houses.push_back(config);
  }
  return houses;
}

/// The two with mirrored rooms.
std::vector<HouseConfig> symmetric_houses() {
  std::vector<HouseConfig> houses = extreme_houses();
  for (HouseConfig& config : houses) {
    config.symmetric = true;
    config.high_rooms = false;
  }
  return houses;
}

/// Points every 5 cm along a route.
std::vector<Vector3d> along(const std::vector<Vector3d>& route) {
  std::vector<Vector3d> points;
  for (std::size_t i = 1; i < route.size(); ++i) {
    const int steps = static_cast<int>(std::ceil((route[i] - route[i - 1]).norm() / 0.05));
    for (int k = 0; k < steps; ++k) {
      points.push_back(route[i - 1] + (route[i] - route[i - 1]) * k / steps);
    }
  }
  return points;
}

const Room* room_at(const HousePlan& plan, const Vector3d& p) {
  for (const Room& room : plan.rooms) {
    if (room.floor.contains(Vector2d(p.head<2>()))) return &room;
  }
  return nullptr;
}

TEST(House, SameSeedGivesTheSameHouseAndAnotherSeedAnother) {
  const world::WorldModel a = make_house(coarse_house(), 5);
  const world::WorldModel b = make_house(coarse_house(), 5);
  const world::WorldModel c = make_house(coarse_house(), 6);
  EXPECT_EQ(a.mesh.vertices, b.mesh.vertices);
  EXPECT_EQ(a.mesh.triangles, b.mesh.triangles);
  EXPECT_EQ(a.routes, b.routes);
  EXPECT_NE(a.mesh.vertices, c.mesh.vertices);
  EXPECT_NE(a.routes, c.routes);
}

TEST(House, IsRichEnough) {
  const HousePlan plan = plan_house(HouseConfig{}, 1);
  EXPECT_GE(plan.rooms.size(), 6U);
  EXPECT_EQ(std::ranges::count_if(plan.rooms, [](const Room& r) { return r.height > 5; }), 2);
  EXPECT_GE(make_house(HouseConfig{}, 1).mesh.triangles.size(), 200000U);
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const HouseConfig config = coarse_house();
    const auto objects = furnish_house(plan_house(config, seed), config, seed);
    EXPECT_GE(objects.size(), 40U);
    std::multiset<std::string> kinds;
    for (const PlacedObject& object : objects) kinds.insert(object.kind);
    EXPECT_EQ(kinds.count("bed"), 2U) << "seed " << seed;
    EXPECT_GE(kinds.count("chair"), 4U) << "seed " << seed;
    for (const char* kind : {"bed", "sofa", "dining table", "chair", "bookshelf", "stairs",
                             "gallery", "plant", "curtain", "pendant lamp", "wardrobe"}) {
      EXPECT_TRUE(kinds.contains(kind)) << kind << " in seed " << seed;
    }
  }
}

TEST(House, HasPlasterWoodClothGlassMirrorsAndADarkScreen) {
  const world::WorldModel house = make_house(HouseConfig{}, 1);
  ASSERT_EQ(house.mesh.material_ids.size(), house.mesh.triangles.size());
  std::map<std::string, double> area;
  for (std::size_t i = 0; i < house.mesh.triangles.size(); ++i) {
    area[house.mesh.material(i).name] += 0.5 * house.mesh.cross(i).norm();
  }
  for (const char* name : {"plaster", "wood", "fabric", "glass", "mirror", "dark screen"}) {
    EXPECT_GT(area[name], 0.5) << name;  // m^2, both sides and the rims counted
  }
  EXPECT_GT(area["plaster"], 0.5 * house.mesh.area());
  EXPECT_LT(area["glass"], 0.1 * house.mesh.area());
}

TEST(House, TheShippedFileIsTheDefaultHouseWithTheCallersSeed) {
  LogSink log;
  WorldOptions options;
  options.seed = 3;
  const std::filesystem::path configs = LIDARENA_SOURCE_DIR "/configs";
  const world::WorldModel loaded = load_world(configs / "worlds/house.yaml", options, log);
  const world::WorldModel made = make_house(HouseConfig{}, 3);
  EXPECT_EQ(loaded.name, "house");
  EXPECT_EQ(loaded.mesh.vertices, made.mesh.vertices);
  EXPECT_EQ(loaded.routes, made.routes);
}

TEST(House, RoomsFillTheHouseWithoutOverlap) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const HouseConfig config;
    const HousePlan plan = plan_house(config, seed);
    double area = 0;
    for (std::size_t i = 0; i < plan.rooms.size(); ++i) {
      area += plan.rooms[i].floor.volume();
      for (std::size_t j = 0; j < i; ++j) {
        const auto common = plan.rooms[i].floor.intersection(plan.rooms[j].floor);
        EXPECT_TRUE(common.isEmpty() || common.volume() == 0);
      }
    }
    EXPECT_NEAR(area, config.width_m * config.depth_m, 1e-9);
  }
}

TEST(House, CeilingsAreOneOrTwoStoriesUp) {
  const HouseConfig config = coarse_house();
  const HousePlan plan = plan_house(config, 1);
  const world::World shell(build_shell(plan, config), "shell");
  for (const Room& room : plan.rooms) {
    const Vector2d middle = room.floor.center();
    const std::array<world::Ray, 2> rays{
        world::Ray{{middle.x(), middle.y(), 1.0}, Eigen::Vector3f::UnitZ()},
        world::Ray{{middle.x(), middle.y(), 1.0}, -Eigen::Vector3f::UnitZ()}};
    std::array<world::Hit, 2> hits;
    shell.cast(rays, 100, hits);
    EXPECT_NEAR(hits[0].range, room.height - 1, 1e-5);
    EXPECT_NEAR(hits[1].range, 1, 1e-5);
  }
}

TEST(House, DoorsAreAsWideAsAskedAndPassWallsOfRealThickness) {
  const HouseConfig config = coarse_house();
  const world::WorldModel house = make_house(config, 3);
  const world::World world(house.mesh, "house");
  const HousePlan plan = plan_house(config, 3);
  EXPECT_GE(plan.doors.size(), 7U);
  for (const Opening& door : plan.doors) {
    const Eigen::Vector3f side =
        door.axis == 0 ? Eigen::Vector3f::UnitX() : Eigen::Vector3f::UnitY();
    for (double z = 0.1; z < config.door_height_m - 0.05; z += 0.15) {
      for (const double ahead : {-0.49, 0.0, 0.49}) {
        const Vector3d p = door.point(ahead * config.wall_thickness_m, z);
        const std::array<world::Ray, 2> rays{world::Ray{p, side}, world::Ray{p, -side}};
        std::array<world::Hit, 2> hits;
        world.cast(rays, 100, hits);
        EXPECT_NEAR(hits[0].range + hits[1].range, config.door_width_m, 1e-5);
        EXPECT_LE(hits[0].range + hits[1].range, 0.9F + 1e-5F);
      }
    }
  }
}

HouseConfig open_house() {
  HouseConfig config = coarse_house();
  config.passage_width_m = 2.4;
  config.furnishing = 0.3;
  config.panes = false;
  return config;
}

TEST(House, PassagesAreHighWideHolesAndMoveNothingElse) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const HousePlan doors = plan_house(coarse_house(), seed);
    const HousePlan plan = plan_house(open_house(), seed);
    double width = 0.0;
    ASSERT_EQ(plan.doors.size(), doors.doors.size());
    for (std::size_t i = 0; i < plan.doors.size(); ++i) {
      EXPECT_EQ(plan.doors[i].center, doors.doors[i].center);
      EXPECT_GE(plan.doors[i].width, doors.doors[i].width);
      EXPECT_LE(plan.doors[i].width, 2.4);
      EXPECT_EQ(plan.doors[i].head, open_house().story_height_m - 0.3);
      width += plan.doors[i].width / static_cast<double>(plan.doors.size());
    }
    EXPECT_GT(width, 1.6) << "more often wide than not, seed " << seed;
    for (std::size_t i = 0; i < plan.rooms.size(); ++i)
      EXPECT_TRUE(plan.rooms[i].floor.isApprox(doors.rooms[i].floor));
  }
}

TEST(House, ThePassagesAreThereInTheMesh) {
  const HouseConfig config = open_house();
  const world::World world(make_house(config, 3).mesh, "house");
  for (const Opening& door : plan_house(config, 3).doors) {
    const Eigen::Vector3f side =
        door.axis == 0 ? Eigen::Vector3f::UnitX() : Eigen::Vector3f::UnitY();
    const Vector3d p = door.point(0.0, 1.0);
    const std::array<world::Ray, 3> rays{world::Ray{p, side}, world::Ray{p, -side},
                                         world::Ray{p, Eigen::Vector3f::UnitZ()}};
    std::array<world::Hit, 3> hits;
    world.cast(rays, 100, hits);
    EXPECT_NEAR(hits[0].range + hits[1].range, door.width, 1e-5);
    EXPECT_NEAR(hits[2].range, door.head - 1.0, 1e-5);
  }
}

TEST(House, RouteIsAClosedTourOfAllRoomsAndDoors) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const HouseConfig config;
    const HousePlan plan = plan_house(config, seed);
    EXPECT_EQ(plan.route.front(), plan.route.back());
    double length = 0;
    for (std::size_t i = 1; i < plan.route.size(); ++i) {
      length += (plan.route[i] - plan.route[i - 1]).norm();
    }
    EXPECT_GE(length, 60);
    EXPECT_LE(length, 120);
    std::set<const Room*> rooms;
    for (const Vector3d& p : plan.route) {
      const Room* room = room_at(plan, p);
      ASSERT_NE(room, nullptr);
      rooms.insert(room);
      EXPECT_GE(p.z(), 0.8);
      EXPECT_LE(p.z(), room->height > config.story_height_m ? 4 : 2);
    }
    EXPECT_EQ(rooms.size(), plan.rooms.size());
    for (const Opening& door : plan.doors) {
      // One leg passes the door's center along the wall's normal, 0.8 m on either side.
      const Vector3d a = door.point(-0.8, 0.5 * door.head);
      const Vector3d b = door.point(0.8, 0.5 * door.head);
      bool passed = false;
      for (std::size_t i = 1; i < plan.route.size(); ++i) {
        passed = passed || (plan.route[i - 1].isApprox(a) && plan.route[i].isApprox(b)) ||
                 (plan.route[i - 1].isApprox(b) && plan.route[i].isApprox(a));
      }
      EXPECT_TRUE(passed);
    }
  }
}

void expect_clear_route(const HouseConfig& config, std::uint64_t seed) {
  const world::WorldModel house = make_house(config, seed);
  ASSERT_EQ(house.routes.size(), 1U);
  const world::World world(house.mesh, "house");
  for (const Vector3d& p : along(house.routes[0])) {
    const world::ClosestPoint nearest = world.closest_point(p);
    ASSERT_GE(nearest.distance, 0.4)
        << "seed " << seed << " at " << p.transpose() << " to " << nearest.point.transpose();
  }
}

TEST(House, RouteKeepsClearOfEverySurface) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) expect_clear_route(coarse_house(), seed);
}

TEST(House, RouteKeepsClearWithPassages) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) expect_clear_route(open_house(), seed);
  for (HouseConfig config : extreme_houses()) {
    config.passage_width_m = 2.4;
    for (std::uint64_t seed = 1; seed <= 3; ++seed) expect_clear_route(config, seed);
  }
}

TEST(House, RouteKeepsClearInTheSmallestAndTheLargestHouse) {
  for (const HouseConfig& config : extreme_houses()) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) expect_clear_route(config, seed);
  }
}

TEST(House, RouteKeepsClearInSymmetricHouses) {
  for (const HouseConfig& config : symmetric_houses()) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) expect_clear_route(config, seed);
  }
}

TEST(House, RoomsAndAllDoorsButOneOfASymmetricHouseAreMirrored) {
  for (const HouseConfig& config : symmetric_houses()) {
    const HousePlan plan = plan_house(config, 4);
    for (const Room& room : plan.rooms) {
      const double mirrored = config.width_m - room.floor.max().x();
      EXPECT_TRUE(std::ranges::any_of(plan.rooms, [&](const Room& other) {
        return (other.floor.min() - Vector2d(mirrored, room.floor.min().y())).norm() < 1e-9 &&
               (other.floor.sizes() - room.floor.sizes()).norm() < 1e-9;
      }));
    }
    const auto has_mirror_image = [&](const Opening& door) {
      const Vector3d place = door.point(0.0, 0.0);
      return std::ranges::any_of(plan.doors, [&](const Opening& other) {
        const Vector3d there = other.point(0.0, 0.0);
        return other.axis == door.axis && std::abs(there.y() - place.y()) < 1e-9 &&
               std::abs(there.x() + place.x() - config.width_m) < 1e-9;
      });
    };
    EXPECT_EQ(std::ranges::count_if(plan.doors, has_mirror_image), 7);
  }
}

/// Share of rays from the route, uniformly distributed over all directions, that hit nothing.
double lost_rays(const HouseConfig& config, std::uint64_t seed) {
  const world::WorldModel house = make_house(config, seed);
  const world::World world(house.mesh, "house");
  SequentialRandom random(1);
  std::vector<world::Ray> rays;
  for (const Vector3d& p : along(house.routes[0])) {
    for (int k = 0; k < 100; ++k)
      rays.push_back({p, world::testing::random_direction(random).cast<float>()});
  }
  std::vector<world::Hit> hits(rays.size());
  world.cast(rays, 1000, hits);
  const auto lost = std::ranges::count_if(hits, [](const world::Hit& hit) { return !hit.valid(); });
  return double(lost) / double(rays.size());
}

TEST(House, WithPanesEveryRayHitsSomething) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) EXPECT_EQ(lost_rays(coarse_house(), seed), 0);
}

TEST(House, WithoutPanesRaysLeaveThroughTheWindows) {
  HouseConfig config = coarse_house();
  config.panes = false;
  const double lost = lost_rays(config, 1);
  EXPECT_GT(lost, 0.005);
  EXPECT_LT(lost, 0.2);
}

TEST(House, WithoutCeilingsTheSkyOpensAndTheRestStays) {
  HouseConfig config = coarse_house();
  config.high_rooms = false;
  const world::WorldModel closed = make_house(config, 1);
  config.ceilings = false;
  const world::WorldModel open = make_house(config, 1);
  EXPECT_EQ(open.routes, closed.routes);
  const world::World under_roof(closed.mesh, "closed"), under_sky(open.mesh, "open");
  SequentialRandom random(1);
  int lost = 0;
  for (int i = 0; i < 4000; ++i) {
    const auto& route = closed.routes[0];
    const world::Ray ray{route[static_cast<std::size_t>(i) % route.size()],
                         world::testing::random_direction(random).cast<float>()};
    world::Hit a, b;
    under_roof.cast({&ray, 1}, 100, {&a, 1});
    under_sky.cast({&ray, 1}, 100, {&b, 1});
    const double height = ray.origin.z() + static_cast<double>(a.range * ray.direction.z());
    if (height < 1.5) {  // below the lamps
      EXPECT_NEAR(a.range, b.range, 1e-4F);
    }
    lost += b.valid() ? 0 : 1;
  }
  EXPECT_GT(lost, 600);
}

/// True when the object stands on the floor, hangs on a wall or from the ceiling, or lies on
/// another's table top.
bool is_held(const PlacedObject& object, const std::vector<PlacedObject>& all,
             const HousePlan& plan, const HouseConfig& config) {
  constexpr double kTouch = 0.025;  // m
  if (std::abs(object.box.min().z()) < kTouch) return true;
  const Room* room = room_at(plan, object.box.center());
  if (room == nullptr) return false;
  if (std::abs(object.box.max().z() - room->height) < kTouch) return true;
  for (int axis = 0; axis < 2; ++axis) {
    const double half = 0.5 * config.wall_thickness_m;
    if (object.box.min()[axis] - room->floor.min()[axis] - half < kTouch) return true;
    if (room->floor.max()[axis] - half - object.box.max()[axis] < kTouch) return true;
  }
  return std::ranges::any_of(all, [&](const PlacedObject& host) {
    return host.top > 0 && std::abs(object.box.min().z() - host.top) < kTouch &&
           host.box.min().x() <= object.box.center().x() &&
           object.box.center().x() <= host.box.max().x() &&
           host.box.min().y() <= object.box.center().y() &&
           object.box.center().y() <= host.box.max().y();
  });
}

TEST(House, NothingFloats) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const HouseConfig config = coarse_house();
    const HousePlan plan = plan_house(config, seed);
    const auto objects = furnish_house(plan, config, seed);
    for (const PlacedObject& object : objects) {
      EXPECT_TRUE(is_held(object, objects, plan, config)) << object.kind << " in seed " << seed;
    }
  }
}

TEST(House, ThingsDoNotStandInOneAnotherOrInDoors) {
  // Rugs lie under objects, chairs are partly under tables, and the parts of the gallery touch.
  const std::set<std::string> shared{"rug", "chair", "stool", "stairs", "gallery", "column"};
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    HouseConfig config = coarse_house();
    if (seed > 6) config.passage_width_m = 2.4;
    const HousePlan plan = plan_house(config, seed);
    const auto objects = furnish_house(plan, config, seed);
    for (std::size_t i = 0; i < objects.size(); ++i) {
      for (const Opening& door : plan.doors) {
        if (objects[i].kind == "rug") continue;
        EXPECT_GT(objects[i].box.exteriorDistance(door.point(0, 1.0)), 0.45) << objects[i].kind;
      }
      for (std::size_t j = 0; j < i; ++j) {
        if (shared.contains(objects[i].kind) || shared.contains(objects[j].kind)) continue;
        const Eigen::AlignedBox3d common = objects[i].box.intersection(objects[j].box);
        if (common.isEmpty()) continue;
        EXPECT_LT(common.sizes().minCoeff(), 0.025)
            << objects[i].kind << " and " << objects[j].kind << " in seed " << seed;
      }
    }
  }
}

TEST(House, TheDistanceOfABoxToARouteIsThatOfItsNearestPoint) {
  const Eigen::AlignedBox3d box(Vector3d(0, 0, 0), Vector3d(1, 1, 1));
  EXPECT_NEAR(distance_to_route(box, {{-2, 0.5, 3}, {3, 0.5, 3}}), 2, 1e-12);
  EXPECT_NEAR(distance_to_route(box, {{2, 2, 0.5}, {2, 2, 4}}), std::numbers::sqrt2, 1e-12);
  EXPECT_EQ(distance_to_route(box, {{-2, 0.5, 0.5}, {3, 0.5, 0.5}}), 0);
}

}  // namespace
}  // namespace lidarena::scenes
