// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <filesystem>

#include "lidarena/flight/figures.hpp"
#include "lidarena/flight/flight_config.hpp"
#include "lidarena/flight/make_flight.hpp"
#include "lidarena/world/load_world.hpp"
#include "tests/flight/flight_conformance.hpp"

namespace lidarena {
namespace {

const std::filesystem::path kConfigs = std::filesystem::path(LIDARENA_SOURCE_DIR) / "configs";

/// The flight as made in the world, lawful, within its limits, clear of the mesh at every 20 ms.
void expect_flyable(const std::filesystem::path& world_file, const std::string& name) {
  LogSink log;
  const auto file = kConfigs / "flights" / (name + ".yaml");
  const WorldModel model = load_world(world_file, {}, log);
  const World world{TriangleMesh(model.mesh)};
  const auto flight = make_flight(file, model, world, log);
  const auto config = load_config<FlightConfig>(file);
  EXPECT_EQ(flight->duration(), from_seconds(config.duration_s));
  conformance::expect_lawful(*flight, 2);
  const FlightFigures figures = figures_of(*flight);
  const FlightLimits limits = limits_of(config);
  EXPECT_LE(figures.max_speed, limits.max_speed * (1.0 + 1e-9));
  EXPECT_LE(figures.max_acceleration, limits.max_acceleration * (1.0 + 1e-9));
  EXPECT_LE(figures.max_tilt, limits.max_tilt * (1.0 + 1e-9));
  EXPECT_GT(figures.length_m, 30.0);
  for (Time t{0}; t <= flight->duration(); t += std::chrono::milliseconds(20)) {
    const Eigen::Vector3d p = flight->pose_at(t).translation();
    ASSERT_GE(world.closest_point(p, 2.0 * config.clearance_m).distance, config.clearance_m);
  }
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

TEST_P(OwnWorlds, AreFlownAlongTheirRoutes) {
  const auto world = kConfigs / "worlds" / (std::string(GetParam()) + ".yaml");
  if (!std::filesystem::exists(world)) GTEST_SKIP() << "no world file " << world;
  expect_flyable(world, GetParam());
}

TEST(ShippedFlights, TheSmallHouseIsFlownThroughItsRooms) {
  const auto world = std::filesystem::path(LIDARENA_SHARED_DATA) /
                     "meshes/aws_small_house/worlds/small_house.world";
  if (!std::filesystem::exists(world)) GTEST_SKIP() << "the small house was skipped: no mesh";
  expect_flyable(world, "aws_house");
}

}  // namespace
}  // namespace lidarena
