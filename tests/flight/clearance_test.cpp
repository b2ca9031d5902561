// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/clearance.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "lidarena/flight/spline_flight.hpp"
#include "tests/flight/flight_scenes.hpp"

namespace lidarena::flight {
namespace {

using Eigen::Vector3d;

SplineFlight straight(const Vector3d& from, const Vector3d& to) {
  return SplineFlight(std::vector<Vector3d>{from, to}, {}, "test");
}

const world::World& walls() {
  static const world::World world(test_scenes::wall_with_door());
  return world;
}

TEST(Clearance, ADoorIsPassedWithHalfItsWidthAndNotWithMore) {
  const SplineFlight through = straight({-2, 0, 1}, {2, 0, 1});
  EXPECT_FALSE(first_encounter(through, walls(), 0.449).has_value());
  EXPECT_TRUE(first_encounter(through, walls(), 0.451).has_value());
}

TEST(Clearance, ReportsTimePlaceAndDistanceOfTheFirstBreach) {
  const SplineFlight into = straight({-2, 1.5, 1}, {2, 1.5, 1});
  const auto encounter = first_encounter(into, walls(), 0.3);
  ASSERT_TRUE(encounter.has_value());
  // the face of the wall is at x = -0.05; one step of 5 ms is at most 2.5 m/s * 5 ms
  EXPECT_NEAR(encounter->position.x(), -0.35, 0.0125);
  EXPECT_LE(encounter->distance, 0.3);
  EXPECT_GE(encounter->distance, 0.3 - 0.0125);
  EXPECT_NEAR((encounter->surface - Vector3d(-0.05, 1.5, 1)).norm(), 0.0, 1e-5);
  EXPECT_EQ(encounter->position, into.pose_at(encounter->time).translation());
}

TEST(Clearance, AThinSheetIsNotSlippedThroughBetweenTwoSamples) {
  world::TriangleMesh sheet;
  sheet.vertices = {{0, -1, 0}, {0, 1, 0}, {0, 0, 2}};
  sheet.triangles = {{0, 1, 2}};
  const world::World world(std::move(sheet));
  FlightConfig config;
  config.limits.max_speed = 50.0;
  config.limits.max_acceleration = 8.0;
  config.limits.max_tilt = 1.0;
  const SplineFlight fast(std::vector<Vector3d>{{-100.003, 0, 1}, {100, 0, 1}}, config, "test");
  const auto encounter = first_encounter(fast, world, 0.0);
  ASSERT_TRUE(encounter.has_value());
  EXPECT_NEAR(encounter->position.x(), 0.0, 0.25);  // 50 m/s * 5 ms
  const SplineFlight above(std::vector<Vector3d>{{-100, 0, 2.1}, {100, 0, 2.1}}, config, "test");
  EXPECT_FALSE(first_encounter(above, world, 0.0).has_value());
}

TEST(Clearance, AgreesWithAskingTheWorldAtEverySample) {
  const std::vector<Vector3d> line{{-2, 0.1, 1}, {1, 0, 1}, {1, 2, 3.2}, {-1, 2, 3.2}};
  const SplineFlight flight(line, {}, "test");
  double nearest = std::numeric_limits<double>::infinity();
  for (Time t{0}; t <= flight.duration(); t += std::chrono::milliseconds(5)) {
    nearest = std::min(nearest, walls().closest_point(flight.pose_at(t).translation()).distance);
  }
  ASSERT_GT(nearest, 0.05);
  EXPECT_FALSE(first_encounter(flight, walls(), nearest - 1e-5).has_value());
  EXPECT_TRUE(first_encounter(flight, walls(), nearest + 0.0125).has_value());
}

}  // namespace
}  // namespace lidarena::flight
