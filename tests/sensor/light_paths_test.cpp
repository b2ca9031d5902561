// SPDX-License-Identifier: BSD-3-Clause
// What is seen through panes, in mirrors and below wet floors, compared with geometry.
#include <gtest/gtest.h>

#include <cmath>
#include <span>

#include "lidarena/sensor/light_paths.hpp"

#include "tests/sensor/surroundings.hpp"

namespace lidarena::sensor {
namespace {

using Eigen::Vector3d;
using namespace testing;
using namespace world::testing;

SensorConfig that_sees_beyond(int bounces, EchoChoice choice) {
  SensorConfig config = mid360_at_origin();
  config.noise.bounces = bounces;
  config.returns.choice = choice;
  return config;
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
