// SPDX-License-Identifier: BSD-3-Clause
// Drift with temperature and halos of reflectors, compared with closed forms and statistics; and
// all that surrounds a LiDAR at once.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "lidarena/base/angle.hpp"
#include "lidarena/sensor/range_drift.hpp"

#include "tests/sensor/surroundings.hpp"

namespace lidarena::sensor {
namespace {

using Eigen::Vector3d;
using namespace testing;
using namespace world::testing;

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

/// A traffic sign, 0.6 m by 0.6 m, facing the sensor from 8 m.
world::TriangleMesh traffic_sign() {
  return sheet({8, -0.3, -0.3}, {0, 0.6, 0}, {0, 0, 0.6}, world::materials::kSign);
}

SensorConfig that_blooms(double share, int rays) {
  SensorConfig config = in_air({});
  config.body_from_lidar.linear() =
      Eigen::AngleAxisd(radians(20), Vector3d::UnitY()).toRotationMatrix();  // beams around +x
  config.noise.blooming = {share, 3.0, rays};
  return config;
}

/// Share of the scattered light of a beam that the sign gets, by a sum over the sign.
double share_on_sign(const Vector3d& beam) {
  const double w = radians(3.0) / std::sqrt(3.0), cell = 0.05;
  double share = 0.0;
  for (double y = -0.3 + 0.5 * cell; y < 0.3; y += cell) {
    for (double z = -0.3 + 0.5 * cell; z < 0.3; z += cell) {
      const Vector3d at(8.0, y, z);
      const double angle = std::acos(std::min(1.0, beam.dot(at.normalized())));
      const double solid = cell * cell * 8.0 / std::pow(at.norm(), 3);
      const double slope = angle / (w * w) * std::pow(1.0 + angle * angle / (w * w), -1.5);
      share += slope / (2.0 * std::numbers::pi * std::sin(angle)) * solid;
    }
  }
  return share;
}

TEST(Blooming, HalfOfTheLightIsWithinTheHalfAngle) {
  EXPECT_NEAR(glare_angle(0.02, 0.5), 0.02, 1e-15);
  EXPECT_EQ(glare_angle(0.02, 0.0), 0.0);
  for (const double u : {0.1, 0.7, 0.99}) {
    const double x = glare_angle(0.02, u) / 0.02;
    EXPECT_NEAR(1.0 - 1.0 / std::sqrt(1.0 + 3.0 * x * x), u, 1e-12);
  }
}

/// With one ray per shot, a beam beside the sign sees it with the probability that is its share.
TEST(Blooming, BeamsBesideASignSeeItAsOftenAsTheScatteredLightMeetsIt) {
  const world::World world = world_of({traffic_sign()});
  const SensorConfig config = that_blooms(0.1, 1);
  const auto pattern = make_pattern(config);
  const std::array<double, 5> edges{4, 6, 9, 14, 25};  // deg from the sign's center
  std::array<double, 4> expected{}, seen{};
  const auto bin_of = [&](const Vector3d& direction) {
    const double angle = degrees(std::acos(std::min(1.0, direction.x())));
    return static_cast<std::size_t>(std::ranges::upper_bound(edges, angle) - edges.begin());
  };
  std::vector<Beam> beams;
  for (std::uint64_t index = 0; index < 20; ++index) {
    pattern->beams(index, beams);
    for (const Beam& beam : beams) {
      const Vector3d direction = config.body_from_lidar.linear() * beam.direction.cast<double>();
      const std::size_t bin = bin_of(direction);
      if (bin > 0 && bin < edges.size()) expected[bin - 1] += share_on_sign(direction);
    }
    const Received halo = received(config, world, index);
    for (std::size_t i = 0; i < halo.truth.size(); ++i) {
      const Vector3d point = config.body_from_lidar * halo.scan.points[i].position.cast<double>();
      const std::size_t bin = bin_of(point.normalized());
      if (bin == 0) continue;
      ASSERT_EQ(halo.truth[i].triangle, kGhost);
      ASSERT_NEAR(point.norm(), 8.0, 0.03);
      ASSERT_LT((halo.truth[i].position.cast<double>() - point).norm(), 1e-4);
      if (bin < edges.size()) ++seen[bin - 1];
    }
  }
  for (std::size_t bin = 0; bin < seen.size(); ++bin) {
    ASSERT_GT(expected[bin], 20.0);
    EXPECT_NEAR(seen[bin], expected[bin], 4.0 * std::sqrt(expected[bin])) << bin;
  }
}

TEST(Blooming, ReturnsWholeRaysOfItsShareOfTheLight) {
  const world::World world = world_of({traffic_sign()});
  const double of_one_ray = 0.0008 / 4 * 800.0;
  const Received halo = received(that_blooms(0.0008, 4), world);
  std::size_t ghosts = 0;
  for (std::size_t i = 0; i < halo.truth.size(); ++i) {
    if (halo.truth[i].triangle != kGhost) continue;
    const double rays = energy_of(halo.scan.points[i]) / of_one_ray;  // each times a cosine
    ASSERT_GT(rays, 0.99);
    ASSERT_NEAR(rays, std::round(rays), 0.01 * std::round(rays));
    ++ghosts;
  }
  EXPECT_GT(ghosts, 20U);
}

/// Where the wall's signal is above that of the halo, the wall is reported with its own noise.
TEST(Blooming, LosesAgainstAStrongerWallAndLeavesItsNoiseAsItIs) {
  SensorConfig config = that_blooms(0.0005, 1);
  config.returns.choice = EchoChoice::kStrongest;
  config.range_noise_m = 0.02;
  const world::World walled = world_of({traffic_sign(), upright(12, kWhiteWall)});
  const Received with = received(config, walled);
  config.noise.blooming.share = 0.0;
  const Received without = received(config, walled);
  ASSERT_EQ(with.scan.points.size(), without.scan.points.size());
  const SignalModel signal(config.noise.signal);
  const double of_halo = signal.signal(0.0005 * 800.0, 8.0);
  std::size_t bloomed = 0, walls = 0;
  for (std::size_t i = 0; i < with.scan.points.size(); ++i) {
    const double cosine =
        (config.body_from_lidar * without.scan.points[i].position.cast<double>()).normalized().x();
    if (with.truth[i].triangle == kGhost) {
      ++bloomed;
      EXPECT_LT(signal.signal(0.8 * cosine, 12.0 / cosine), of_halo);
    } else {
      ++walls;
      ASSERT_EQ(with.scan.points[i].position, without.scan.points[i].position);
    }
  }
  EXPECT_GT(bloomed, 10U);
  EXPECT_GT(walls, 1000U);
}

TEST(Blooming, CostsNothingWithoutRetroreflectors) {
  const world::World room(box_mesh({-9, -7, -4}, {8, 6, 3}), "room", world::RayCaster::kBvh);
  EXPECT_FALSE(room.has_retroreflectors());
  EXPECT_TRUE(world_of({traffic_sign()}).has_retroreflectors());
  const SensorConfig config = that_blooms(0.1, 8), plain = that_blooms(0.0, 8);
  EXPECT_TRUE(same(received(config, room).scan, received(plain, room).scan));
}

/// A room with a sign, a wet floor and a pane, in fog and rain, seen by beams of several sub-rays.
TEST(Surroundings, AreTheSameOnAnyNumberOfThreadsAndInAnyPieces) {
  const world::World world =
      world_of({traffic_sign(), upright(12, kWhiteWall), upright(3, kPane),
                sheet({-40, -40, -1}, {80, 0, 0}, {0, 80, 0}, world::materials::kWetFloor)});
  SensorConfig config = that_blooms(0.01, 4);
  config.noise.air = fog(150.0);
  config.noise.air.rain_mm_h = 30.0;
  config.noise.bounces = 2;
  config.noise.drift.warm_up_m = 0.02;
  config.noise.beam.sub_rays = 3;
  config.noise.dropouts = true;
  config.range_noise_m = 0.02;
  config.returns.count = 3;
  const Lidar lidar = make_lidar(config);
  const auto flight = rest(Pose::Identity(), 4000);
  const Scan scan = lidar.measure(world, flight, 7, kOneThread);
  EXPECT_TRUE(same(scan, lidar.measure(world, flight, 7, Parallel(3))));
  std::vector<Beam> storage;
  const std::span<const Beam> beams = lidar.beams(7, storage);
  Scan pieces = lidar.empty_scan(7);
  std::vector<PointTruth> truth;
  for (std::size_t first = 0; first < beams.size(); first += 777) {
    const std::size_t count = std::min<std::size_t>(777, beams.size() - first);
    lidar.measure_part(
        world, [&](std::int32_t) { return config.body_from_lidar; }, beams.subspan(first, count),
        7 * beams.size() + first, pieces.points, &truth);
  }
  EXPECT_TRUE(same(scan, pieces));
  for (const std::uint32_t kind : {kAir, kGhost})
    EXPECT_GT(std::ranges::count(truth, kind, &PointTruth::triangle), 100) << kind;
}

}  // namespace
}  // namespace lidarena::sensor
