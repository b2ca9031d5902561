// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>
#include <numbers>

#include "lidarena/flight/figures.hpp"
#include "lidarena/flight/flight_config.hpp"
#include "lidarena/flight/free_space.hpp"
#include "lidarena/flight/make_flight.hpp"
#include "lidarena/flight/spline_flight.hpp"
#include "lidarena/flight/tour.hpp"
#include "lidarena/scenes/cave.hpp"
#include "lidarena/scenes/load_world.hpp"
#include "tests/flight/flight_conformance.hpp"

namespace lidarena::flight {
namespace {

const std::filesystem::path kConfigs = std::filesystem::path(LIDARENA_SOURCE_DIR) / "configs";
const std::filesystem::path kMeshes = std::filesystem::path(LIDARENA_SHARED_DATA) / "meshes";

struct Scene {
  world::WorldModel model;
  world::World world;
};

/// Cached between tests: generating the cave takes longer than the flight.
const Scene& scene_of(const std::filesystem::path& world_file) {
  static std::map<std::filesystem::path, Scene> scenes;
  auto found = scenes.find(world_file);
  if (found == scenes.end()) {
    LogSink log;
    world::WorldModel model = scenes::load_world(world_file, {}, log);
    world::World world{world::TriangleMesh(model.mesh)};
    found = scenes.emplace(world_file, Scene{std::move(model), std::move(world)}).first;
  }
  return found->second;
}

/// Conforming (see flight_conformance.hpp) and clear of the mesh at samples 20 ms apart.
void expect_lawful_and_clear(const Flight& flight, const world::World& world, double clearance) {
  conformance::expect_lawful(flight, 2);
  for (Time t{0}; t <= flight.duration(); t += std::chrono::milliseconds(20)) {
    const Eigen::Vector3d p = flight.pose_at(t).translation();
    ASSERT_GE(world.closest_point(p, 2.0 * clearance).distance, clearance);
  }
}

/// The flight can be made in the world and stays within its limits.
void expect_flyable(const std::filesystem::path& world_file, const std::string& name) {
  LogSink log;
  const auto file = kConfigs / "flights" / (name + ".yaml");
  const auto& [model, world] = scene_of(world_file);
  const auto flight = make_flight(file, model, world, log);
  const auto config = load_config<FlightConfig>(file);
  EXPECT_EQ(flight->duration(), from_seconds(config.duration_s));
  expect_lawful_and_clear(*flight, world, config.clearance_m);
  const FlightFigures figures = figures_of(*flight);
  const FlightLimits limits = limits_of(config);
  EXPECT_LE(figures.max_speed, limits.max_speed * (1.0 + 1e-9));
  EXPECT_LE(figures.max_acceleration, limits.max_acceleration * (1.0 + 1e-9));
  EXPECT_LE(figures.max_tilt, limits.max_tilt * (1.0 + 1e-9));
  EXPECT_GT(figures.length_m, 30.0);
}

TEST(ShippedFlights, EveryFileIsAValidConfiguration) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kConfigs / "flights")) {
    EXPECT_NO_THROW(load_config<FlightConfig>(entry.path())) << entry.path();
    ++count;
  }
  EXPECT_GE(count, 3);
}

class OwnWorlds : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(ShippedFlights, OwnWorlds, testing::Values("house", "cave"));

/// Checks the paper's requirement: "sudden and drastic changes in both heading and speed".
void expect_aggressive(const Scene& scene, const std::string& name) {
  LogSink log;
  const auto file = kConfigs / "flights" / (name + ".yaml");
  const auto flight = make_flight(file, scene.model, scene.world, log);
  const auto config = load_config<FlightConfig>(file);
  expect_lawful_and_clear(*flight, scene.world, config.clearance_m);
  const FlightFigures figures = figures_of(*flight);
  const FlightLimits limits = limits_of(config);
  // Gusts of 0.5 m/s and the lag of the rotors take the quadrotor beyond the limits of its path.
  EXPECT_LE(figures.max_speed, limits.max_speed + 0.5);
  EXPECT_LE(figures.max_acceleration, 1.1 * limits.max_acceleration);
  EXPECT_LE(figures.max_tilt, limits.max_tilt);
  EXPECT_LE(figures.max_angular_rate, 1.5 * limits.max_yaw_rate) << "of all axes together";
  EXPECT_GT(figures.max_speed, 3.0);
  EXPECT_GT(figures.max_angular_rate, 200.0 * std::numbers::pi / 180.0);
  EXPECT_GT(figures.max_tilt, 25.0 * std::numbers::pi / 180.0);
  EXPECT_GE(figures.fast_share, 0.2);
}

/// Clear of the mesh for as long as the paper's study flies.
void expect_paper_flight_is_clear(const Scene& scene, const std::string& name) {
  LogSink log;
  const auto file = kConfigs / "flights" / (name + ".yaml");
  const auto config = load_config<FlightConfig>(file);
  const auto flight = make_flight(file, scene.model, scene.world, log);
  EXPECT_EQ(flight->duration(), from_seconds(config.duration_s));
  for (Time t{0}; t <= flight->duration(); t += std::chrono::milliseconds(20)) {
    const Eigen::Vector3d p = flight->pose_at(t).translation();
    ASSERT_GE(scene.world.closest_point(p, 2.0 * config.clearance_m).distance, config.clearance_m);
  }
}

/// The recording begins in motion, and lasts as long as that of the flight from rest.
void expect_start_in_motion(const Scene& scene, const std::string& world) {
  LogSink log;
  const auto file = kConfigs / "flights" / (world + "_moving.yaml");
  const auto flight = make_flight(file, scene.model, scene.world, log);
  const auto from_rest =
      load_config<FlightConfig>(kConfigs / "flights" / (world + "_aggressive.yaml"));
  EXPECT_EQ(flight->duration(), from_seconds(from_rest.duration_s));
  for (Time t{0}; t <= std::chrono::seconds(1); t += std::chrono::milliseconds(50))
    EXPECT_GT(flight->at(t).velocity_world.norm(), 1.0) << to_seconds(t);
  EXPECT_GT(flight->at(Time{0}).velocity_world.norm(), 3.5) << "of at most 5 m/s";
}

TEST_P(OwnWorlds, AreFlownAlongTheirRoutesBrisklyAndAggressively) {
  const auto world = kConfigs / "worlds" / (std::string(GetParam()) + ".yaml");
  expect_flyable(world, GetParam());
  expect_aggressive(scene_of(world), std::string(GetParam()) + "_aggressive");
  expect_start_in_motion(scene_of(world), GetParam());
  expect_paper_flight_is_clear(scene_of(world), std::string(GetParam()) + "_paper");
}

TEST(ShippedFlights, TheSmallHouseIsFlownThroughItsRooms) {
  const auto world = kMeshes / "aws_small_house/worlds/small_house.world";
  if (!std::filesystem::exists(world)) GTEST_SKIP() << "the mesh of the small house is missing";
  expect_flyable(world, "aws_house");
}

/// The shipped tour, planned coarsely, is clear of the mesh and sees 80 % of the visible surface.
void expect_tour(const world::WorldModel& model, const world::World& world, double voxel_size_m) {
  auto config = load_config<FlightConfig>(kConfigs / "flights/auto.yaml");
  config.tour.voxel_size_m = voxel_size_m;
  config.tour.max_views = 150;
  config.tour.samples = 1500;
  const Tour tour = plan_tour(model, world, config, "auto.yaml", Parallel());
  EXPECT_GE(tour.seen, 0.8 * tour.seeable) << describe(tour);
  const SplineFlight flight(tour.waypoints, config, "auto.yaml");
  EXPECT_EQ(config.clearance_m, 0.4);
  for (Time t{0}; t <= flight.duration(); t += std::chrono::milliseconds(20)) {
    const Eigen::Vector3d p = flight.pose_at(t).translation();
    ASSERT_GE(world.closest_point(p, 1.0).distance, config.clearance_m);
  }
}

TEST(ShippedTour, ReachesEveryRoomOfTheHouseThroughDoorsThatLeaveFiveCentimeters) {
  const auto& [model, world] = scene_of(kConfigs / "worlds/house.yaml");
  const auto& route = model.routes.front();
  const FreeSpace space(world, route.front(), {0.4, 0.5}, 0.2, 100'000, Parallel());
  for (const Eigen::Vector3d& point : route) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const FreeSpace::Cell& cell : space.cells()) {
      nearest = std::min(nearest, (cell.point - point).norm());
    }
    // a cell's center is at most half a diagonal (0.17 m) away, and its point as far from the
    // center
    EXPECT_LT(nearest, 0.35) << point.transpose();
  }
}

TEST(ShippedTour, ShowsTheHouse) {
  const auto& [model, world] = scene_of(kConfigs / "worlds/house.yaml");
  expect_tour(model, world, 0.2);
}

TEST(ShippedTour, ShowsACaveOfOneLoop) {
  const world::WorldModel model = scenes::make_cave({.loops = 1}, 1);
  expect_tour(model, world::World(world::TriangleMesh(model.mesh)), 0.4);
}

TEST(ShippedTour, ShowsTheLavaTube) {
  const auto file = kMeshes / "lava_tube/models/indian_tunnel/indian_tunnel.dae";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "the mesh of the lava tube is missing";
  const auto& [model, world] = scene_of(file);
  expect_tour(model, world, 0.7);
}

TEST(ShippedTour, ShowsTheSmallHouseThatHasNoCeiling) {
  const auto file = kMeshes / "aws_small_house/worlds/small_house.world";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "the mesh of the small house is missing";
  const auto& [model, world] = scene_of(file);
  expect_tour(model, world, 0.2);
}

}  // namespace
}  // namespace lidarena::flight
