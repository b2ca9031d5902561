// SPDX-License-Identifier: BSD-3-Clause
// What temperature, panes, mirrors, air and reflectors do to a LiDAR, compared with closed forms
// and statistics.
#include <gtest/gtest.h>

#include <cmath>

#include "lidarena/sensor/light_paths.hpp"
#include "lidarena/sensor/range_drift.hpp"
#include "lidarena/sensor/simulate.hpp"
#include "tests/sensor/flights.hpp"
#include "tests/sensor/shipped.hpp"
#include "tests/sensor/worlds.hpp"

namespace lidarena::sensor {
namespace {

using Eigen::Vector3d;
using namespace testing;
using namespace world::testing;

SensorConfig mid360_at_origin() {
  SensorConfig config = mid360();
  config.body_from_lidar.setIdentity();
  config.max_range_m = 200.0;
  return config;
}

struct Received {
  Scan scan;
  std::vector<PointTruth> truth;
};

Received received(const SensorConfig& config, const world::Surfaces& world, std::uint64_t index = 0,
                  std::uint64_t seed = 1) {
  Received received;
  received.scan =
      make_lidar(config, seed)
          .measure(world, rest(Pose::Identity(), 4000), index, kOneThread, &received.truth);
  return received;
}

TEST(RangeDrift, OfWarmUpFallsToItsEthAfterOneTimeConstantAndAgesBeforeTheFlight) {
  const Time tau = std::chrono::seconds(600);
  const DriftConfig cold{0.03, 0.0, 0.0, 0.0, 600.0}, warm{0.03, 600.0, 0.0, 0.0, 600.0};
  EXPECT_DOUBLE_EQ(range_drift(cold, Time{0}), 0.03);
  EXPECT_DOUBLE_EQ(range_drift(cold, tau), 0.03 * std::exp(-1.0));
  EXPECT_DOUBLE_EQ(range_drift(warm, tau), range_drift(cold, 2 * tau));
}

TEST(RangeDrift, OfTemperatureApproachesTheStepTimesItsCoefficient) {
  const DriftConfig config{0.0, 0.0, 0.001, -20.0, 300.0};
  EXPECT_DOUBLE_EQ(range_drift(config, Time{0}), 0.0);
  EXPECT_DOUBLE_EQ(range_drift(config, std::chrono::seconds(300)), -0.02 * (1.0 - std::exp(-1.0)));
  EXPECT_NEAR(range_drift(config, std::chrono::hours(3)), -0.02, 1e-9);
}

TEST(RangeDrift, MovesAllRangesOfAScanByTheDriftAtItsBegin) {
  const world::World wall(wall_mesh(5.0), "wall", world::RayCaster::kBvh);
  SensorConfig config = mid360_at_origin();
  config.noise.drift = {0.04, 30.0, 0.001, 15.0, 200.0};
  for (const std::uint64_t index : {0U, 1000U, 20'000U}) {
    const Received seen = received(config, wall, index);
    const double expected = range_drift(config.noise.drift, std::chrono::milliseconds(100 * index));
    ASSERT_GT(seen.truth.size(), 1000U);
    for (std::size_t i = 0; i < seen.truth.size(); i += 13) {
      const double range = seen.scan.points[i].position.cast<double>().norm();
      ASSERT_NEAR(range - static_cast<double>(seen.truth[i].range), expected, 2e-5);
    }
  }
}

/// A rectangle of one material, with two sides from a corner.
world::TriangleMesh sheet(const Vector3d& corner, const Vector3d& a, const Vector3d& b,
                          const world::Material& material) {
  world::TriangleMesh mesh;
  mesh.vertices = {corner, corner + a, corner + a + b, corner + b};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.paint(material);
  return mesh;
}

world::World world_of(const std::vector<world::TriangleMesh>& parts) {
  world::TriangleMesh all;
  for (const world::TriangleMesh& part : parts) all.append(part);
  return world::World(std::move(all), "parts", world::RayCaster::kBvh);
}

/// The plane x = `x`, 80 m wide and high.
world::TriangleMesh upright(double x, const world::Material& material) {
  return sheet({x, -40, -40}, {0, 80, 0}, {0, 0, 80}, material);
}

const world::Material kWhiteWall{"white wall", 0.8, 0.0};
const world::Material kPane{"pane", 0.08, 0.95, 0.9};

SensorConfig that_sees_beyond(int bounces, EchoChoice choice) {
  SensorConfig config = mid360_at_origin();
  config.noise.bounces = bounces;
  config.returns.choice = choice;
  return config;
}

/// The energy of a return by its intensity.
double energy_of(const Point& point) { return static_cast<double>(point.intensity) / 255.0; }

double cosine_to_x(const Point& point) {
  return std::abs(static_cast<double>(point.position.normalized().x()));
}

TEST(LightPaths, AWallBehindAPaneIsSeenByTheLightThatPassesThePaneTwice) {
  const world::World world = world_of({upright(2, kPane), upright(6, kWhiteWall)});
  const Received seen = received(that_sees_beyond(1, EchoChoice::kLast), world);
  std::size_t walls = 0;
  for (std::size_t i = 0; i < seen.truth.size(); ++i) {
    const Point& point = seen.scan.points[i];
    if (cosine_to_x(point) < 0.3) continue;
    ASSERT_NEAR(static_cast<double>(point.position.x()), 6.0, 1e-4);
    ASSERT_TRUE(is_of_world(seen.truth[i].triangle, 4));
    ASSERT_GE(seen.truth[i].triangle, 2U);
    const double passed = kPane.transmission * entering_share(kPane, cosine_to_x(point));
    ASSERT_NEAR(energy_of(point), passed * passed * 0.8 * cosine_to_x(point), 1e-5);
    ++walls;
  }
  EXPECT_GT(walls, 1000U);
}

TEST(LightPaths, APaneThatIsABoxLetsPassTheFourthPowerOfASurface) {
  world::TriangleMesh pane = box_mesh({2, -40, -40}, {2.01, 40, 40});
  pane.paint(kPane);
  const world::World world = world_of({pane, upright(6, kWhiteWall)});
  const Received seen = received(that_sees_beyond(2, EchoChoice::kLast), world);
  std::size_t walls = 0;
  for (const Point& point : seen.scan.points) {
    if (cosine_to_x(point) < 0.9) continue;
    ASSERT_NEAR(static_cast<double>(point.position.x()), 6.0, 1e-4);
    const double passed = std::pow(0.9 * entering_share(kPane, cosine_to_x(point)), 2);
    ASSERT_NEAR(energy_of(point), passed * passed * 0.8 * cosine_to_x(point), 1e-5);
    ++walls;
  }
  EXPECT_GT(walls, 100U);
}

TEST(LightPaths, AWallBehindTheSensorStandsAsAGhostBehindTheMirrorOrThePane) {
  for (const world::Material& material : {kPane, world::materials::kMirror}) {
    const world::World world = world_of({upright(2, material), upright(-3, kWhiteWall)});
    const Received seen = received(that_sees_beyond(1, EchoChoice::kLast), world);
    std::size_t ghosts = 0;
    for (std::size_t i = 0; i < seen.truth.size(); ++i) {
      const Point& point = seen.scan.points[i];
      if (point.position.x() < 0 || cosine_to_x(point) < 0.3) continue;
      ASSERT_NEAR(static_cast<double>(point.position.x()), 7.0, 1e-4);  // 2 + (2 + 3)
      ASSERT_EQ(seen.truth[i].triangle, kGhost);
      ASSERT_LT((seen.truth[i].position - point.position).norm(), 1e-4);
      ASSERT_NEAR((seen.truth[i].normal + point.position.normalized()).norm(), 0.0, 1e-6);
      const double share = std::pow(world::mirrored_share(material, cosine_to_x(point)), 2);
      ASSERT_NEAR(energy_of(point), share * 0.8 * cosine_to_x(point), 1e-5);
      ++ghosts;
    }
    EXPECT_GT(ghosts, 1000U);
  }
}

TEST(LightPaths, AWetFloorShowsTheWallBelowItAndIsDarkAtGrazingIncidence) {
  const world::Material& wet = world::materials::kWetFloor;
  const double depth = 0.5;  // of the floor below the sensor; the Mid-360 sees 7 deg downwards
  const world::World world =
      world_of({sheet({-40, -40, -depth}, {80, 0, 0}, {0, 80, 0}, wet), upright(20, kWhiteWall)});
  const Received last = received(that_sees_beyond(1, EchoChoice::kLast), world);
  std::size_t ghosts = 0;
  for (std::size_t i = 0; i < last.truth.size(); ++i) {
    const Point& point = last.scan.points[i];
    const Vector3d way = point.position.cast<double>().normalized();
    if (way.z() > -0.03 || way.x() < 0.7 || way.z() * 20 / way.x() > -depth) continue;
    ASSERT_EQ(last.truth[i].triangle, kGhost);
    ASSERT_NEAR(static_cast<double>(point.position.x()), 20.0, 1e-3);
    ASSERT_LT(static_cast<double>(point.position.z()), -depth);
    const double share = std::pow(world::mirrored_share(wet, -way.z()), 2);
    ASSERT_NEAR(energy_of(point), share * 0.8 * way.x(), 1e-5);
    ++ghosts;
  }
  EXPECT_GT(ghosts, 100U);
  const Received first = received(that_sees_beyond(1, EchoChoice::kFirst), world);
  for (std::size_t i = 0; i < first.truth.size(); ++i) {
    if (first.truth[i].triangle > 1) continue;
    const double cosine = -static_cast<double>(first.scan.points[i].position.normalized().z());
    const double lost = std::pow(entering_share(wet, cosine), 2);
    ASSERT_NEAR(energy_of(first.scan.points[i]), lost * world::backscatter(wet, cosine), 1e-5);
  }
}

TEST(LightPaths, ARayBetweenTwoMirrorsEndsAfterTheGivenNumberOfThem) {
  const world::Material& mirror = world::materials::kMirror;
  const world::World world = world_of({upright(2, mirror), upright(-3, mirror)});
  const world::Ray ray{Vector3d::Zero(), Eigen::Vector3f::UnitX()};
  world::Hit first;
  world.cast(std::span(&ray, 1), 100.0, std::span(&first, 1));
  for (const int bounces : {1, 2, 3, 4}) {
    std::vector<PathEnd> ends;
    follow_light(world, Time{0}, ray, first, bounces, 100.0, ends);
    ASSERT_EQ(ends.size(), static_cast<std::size_t>(bounces));
    for (int i = 0; i < bounces; ++i) {
      EXPECT_NEAR(ends[static_cast<std::size_t>(i)].length, 2.0 + 5.0 * (i + 1), 1e-5);
      EXPECT_NEAR(ends[static_cast<std::size_t>(i)].share, std::pow(0.9 * 0.999, 2 * (i + 1)),
                  1e-9);
    }
  }
}

TEST(LightPaths, InAWorldWithoutGlossEveryMeasurementStays) {
  const world::World room(box_mesh({-9, -7, -4}, {8, 6, 3}), "room", world::RayCaster::kBvh);
  SensorConfig config = mid360_at_origin();
  config.range_noise_m = 0.02;
  config.noise.angle_noise_deg = 0.1;
  const Received before = received(config, room);
  config.noise.bounces = 3;
  EXPECT_TRUE(same(before.scan, received(config, room).scan));
}

}  // namespace
}  // namespace lidarena::sensor
