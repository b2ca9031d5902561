// SPDX-License-Identifier: BSD-3-Clause
// What temperature, panes, mirrors, air and reflectors do to a LiDAR, compared with closed forms
// and statistics.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "lidarena/base/angle.hpp"
#include "lidarena/sensor/air.hpp"
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

/// A Mid-360 that is rated for 40 m and 70 m, with a beam of 0.2 deg.
SensorConfig in_air(const AirConfig& air) {
  SensorConfig config = mid360_at_origin();
  config.noise.signal = {.range_at_10_m = 40.0, .range_at_80_m = 70.0};
  config.noise.beam.width_deg = config.noise.beam.height_deg = 0.2;
  config.noise.air = air;
  config.returns.choice = EchoChoice::kFirst;
  return config;
}

Air air_of(const SensorConfig& config) {
  return {config.noise,
          SignalModel(config.noise.signal),
          config.min_range_m,
          config.max_range_m,
          "a",
          1};
}

AirConfig fog(double visibility_m) {
  AirConfig air;
  air.visibility_m = visibility_m;
  return air;
}

AirConfig rain(double mm_h) {
  AirConfig air;
  air.rain_mm_h = mm_h;
  return air;
}

/// Sum of f at the middles of `steps` steps from `low` to `high`, times the step.
template <class F>
double integral(double low, double high, int steps, F&& f) {
  const double step = (high - low) / steps;
  double sum = 0.0;
  for (int i = 0; i < steps; ++i) sum += step * f(low + (i + 0.5) * step);
  return sum;
}

/// Marshall and Palmer's number of drops by diameter, m^-4.
double drops(double diameter, double mm_h) {
  return 8e6 * std::exp(-4100.0 * std::pow(mm_h, -0.21) * diameter);
}

world::World ball(double radius) {
  return world::World(sphere_mesh(radius, 6), "ball", world::RayCaster::kBvh);
}

/// Compares counts in bins of `bin` m with a probability of a return nearer than a range.
template <class F>
void expect_ranges(const std::vector<double>& ranges, std::size_t shots, double bin, double end,
                   F&& nearer) {
  std::vector<double> counts(static_cast<std::size_t>(end / bin), 0.0);
  for (const double range : ranges) {
    const auto i = static_cast<std::size_t>(range / bin);
    if (i < counts.size()) ++counts[i];
  }
  const auto all = static_cast<double>(shots);
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double low = bin * static_cast<double>(i);
    const double expected = all * (nearer(low + bin) - nearer(low));
    EXPECT_NEAR(counts[i], expected, 4.5 * std::sqrt(expected) + 1.0) << low;
  }
}

std::vector<double> ranges_of_air(const SensorConfig& config, const world::World& world,
                                  std::size_t scans) {
  std::vector<double> ranges;
  for (std::uint64_t index = 0; index < scans; ++index) {
    const Received seen = received(config, world, index);
    for (std::size_t i = 0; i < seen.truth.size(); ++i) {
      if (seen.truth[i].triangle != kAir) continue;
      ranges.push_back(static_cast<double>(seen.truth[i].range));
      EXPECT_LT((seen.truth[i].position - seen.scan.points[i].position).norm(), 1e-4F);
    }
  }
  return ranges;
}

TEST(Air, HasTheExtinctionOfItsVisibilityAndOfItsDrops) {
  const Air foggy = air_of(in_air(fog(80)));
  EXPECT_NEAR(std::exp(-80.0 * foggy.extinction()), 0.05, 1e-12);
  EXPECT_NEAR(foggy.passed(80), 0.05 * 0.05, 1e-12);
  for (const double mm_h : {1.0, 25.0, 100.0}) {
    const double expected = integral(0.0, 0.03, 100'000, [&](double d) {
      return 2.0 * 0.25 * std::numbers::pi * d * d * drops(d, mm_h);
    });
    EXPECT_NEAR(air_of(in_air(rain(mm_h))).extinction() / expected, 1.0, 1e-5);
  }
}

TEST(Air, WeakensEveryReturnByTheWayThereAndBackAndSoLosesTargets) {
  const world::World world = ball(30.0);
  SensorConfig config = in_air(fog(100.0));
  config.returns.choice = EchoChoice::kLast;
  SensorConfig without = config;
  without.noise.air = {};
  const Received clear = received(without, world), foggy = received(config, world);
  ASSERT_EQ(clear.scan.points.size(), foggy.scan.points.size());
  const double extinction = std::log(20.0) / 100.0;
  for (std::size_t i = 0; i < clear.scan.points.size(); i += 7) {
    const auto range = static_cast<double>(foggy.truth[i].range);
    ASSERT_NEAR(energy_of(foggy.scan.points[i]) / energy_of(clear.scan.points[i]),
                std::exp(-2.0 * extinction * range), 1e-5);
  }
  config.noise.air.visibility_m = 60.0;
  config.noise.dropouts = true;
  const SignalModel signal(config.noise.signal);
  const double energy = 0.5 * std::exp(-2.0 * std::log(20.0) / 60.0 * 30.0);  // at normal incidence
  const double expected = signal.detection_probability(signal.signal(energy, 30.0));
  ASSERT_GT(expected, 0.1);
  ASSERT_LT(expected, 0.9);
  const std::vector<PointTruth> seen = received(config, world).truth;
  const auto of_world =
      std::ranges::count_if(seen, [](const PointTruth& point) { return point.triangle != kAir; });
  const auto shots = static_cast<double>(clear.scan.points.size());
  EXPECT_NEAR(static_cast<double>(of_world) / shots, expected,
              0.01);  // the facets are up to 1 deg from normal incidence
}

/// The slow way: the product over the cells before a range, by the receiver's formula.
TEST(Air, OfFogReturnsWhereItsSoftTargetExceedsTheThreshold) {
  const world::World world = ball(30.0);
  const SensorConfig config = in_air(fog(300.0));
  const SignalModel signal(config.noise.signal);
  const double extinction = std::log(20.0) / 300.0, step = config.noise.beam.pulse_length_m;
  const auto nearer = [&](double range) {
    double none = 1.0;
    for (double cell = config.min_range_m; cell < range; cell += step) {
      const double r = cell + 0.5 * step;
      const double overlap = std::clamp((r - 0.9) / 0.1, 0.0, 1.0);
      const double reflectivity = std::numbers::pi * extinction / 65.0 * step;
      const double energy = overlap * reflectivity * std::exp(-2.0 * extinction * r);
      const double noise = signal.detection_probability(0.0);
      const double found = signal.detection_probability(signal.signal(energy, r));
      const double by_fog = (found - noise) / (1.0 - noise);
      none *= 1.0 - by_fog * std::min(1.0, (range - cell) / step);
    }
    return 1.0 - none;
  };
  const std::vector<double> ranges = ranges_of_air(config, world, 5);
  const std::size_t shots = 5 * make_pattern(config)->beams_per_scan();
  ASSERT_GT(ranges.size(), 1000U);
  expect_ranges(ranges, shots, 0.5, 12.0, nearer);
  const Air air = air_of(config);
  for (const double range : {0.5, 1.3, 2.6, 7.1, 29.0})
    EXPECT_NEAR(air.fog_probability(range), nearer(range), 1e-9);
}

/// The slow way: a double integral over ranges and diameters of the drops that are seen.
TEST(Air, OfRainReturnsFromDropsThatAreLargeEnoughToBeSeen) {
  const world::World world = ball(30.0);
  const double mm_h = 40.0;
  const SensorConfig config = in_air(rain(mm_h));
  const SignalModel signal(config.noise.signal);
  const double extinction = air_of(config).extinction();
  const auto rate = [&](double r) {
    const double diameter = 0.01 + radians(0.2) * r;
    const double area = 0.25 * std::numbers::pi * diameter * diameter;
    const double overlap = std::clamp((r - 0.9) / 0.1, 0.0, 1.0);
    return area * integral(0.0, 0.01, 2000, [&](double d) {
             const double per_sr = 2.0 * 0.25 * std::numbers::pi * d * d / 18.8;
             const double energy =
                 overlap * std::numbers::pi * per_sr / area * std::exp(-2.0 * extinction * r);
             return signal.signal(energy, r) >= 1.0 ? drops(d, mm_h) : 0.0;
           });
  };
  const Air air = air_of(config);
  const auto nearer = [&](double range) {
    return 1.0 - std::exp(-integral(config.min_range_m, range, 200, rate));
  };
  for (const double range : {1.5, 4.0, 10.0, 25.0})
    EXPECT_NEAR(air.drop_probability(range) / nearer(range), 1.0, 0.02);
  const std::vector<double> ranges = ranges_of_air(config, world, 5);
  const std::size_t shots = 5 * make_pattern(config)->beams_per_scan();
  ASSERT_GT(ranges.size(), 500U);
  expect_ranges(ranges, shots, 1.0, 20.0, [&](double r) { return air.drop_probability(r); });
}

TEST(Air, DropsHaveTheDiametersAboveTheLeastOneThatIsSeen) {
  const SensorConfig config = in_air(rain(40.0));
  const SignalModel signal(config.noise.signal);
  const Air air = air_of(config);
  std::vector<Air::Return> found;
  for (std::uint64_t ray = 0; ray < 400'000; ++ray) air.add_returns(ray, 30.0, found);
  ASSERT_GT(found.size(), 1000U);
  double mean = 0.0;
  for (const Air::Return& drop : found) {
    const double diameter = 0.01 + radians(0.2) * drop.range;
    const double area = 0.25 * std::numbers::pi * diameter * diameter;
    const double at_1_m = std::numbers::pi * 2.0 * 0.25 * std::numbers::pi / 18.8 / area *
                          std::clamp((drop.range - 0.9) / 0.1, 0.0, 1.0) * air.passed(drop.range);
    ASSERT_GE(signal.signal(drop.energy, drop.range), 1.0 - 1e-9);
    const double least = 1.0 / std::sqrt(signal.signal(at_1_m, drop.range));
    mean += (std::sqrt(drop.energy / at_1_m) - least) / static_cast<double>(found.size());
  }
  const double expected = std::pow(40.0, 0.21) / 4100.0;  // of an exponential distribution
  EXPECT_NEAR(mean / expected, 1.0, 4.0 / std::sqrt(static_cast<double>(found.size())));
}

TEST(Air, LeavesTheNoiseOfEveryReturnOfTheWorldAsItIs) {
  const world::World room(box_mesh({-9, -7, -4}, {8, 6, 3}), "room", world::RayCaster::kBvh);
  SensorConfig config = in_air({});
  config.range_noise_m = 0.02;
  config.noise.angle_noise_deg = 0.1;
  config.noise.dropouts = true;
  const Received clear = received(config, room);
  config.noise.air = fog(400.0);
  config.noise.air.rain_mm_h = 60.0;
  for (const int count : {1, 2}) {
    config.returns.count = count;
    const Received wet = received(config, room);
    std::map<std::pair<std::int32_t, int>, const Point*> by_shot;
    for (const Point& point : clear.scan.points) by_shot[{point.dt_ns, point.ring}] = &point;
    std::size_t of_air = 0;
    for (std::size_t i = 0; i < wet.truth.size(); ++i) {
      if (wet.truth[i].triangle == kAir) {
        ++of_air;
        continue;
      }
      const Point& point = wet.scan.points[i];
      ASSERT_EQ(point.position, (by_shot.at({point.dt_ns, point.ring})->position));
    }
    EXPECT_GT(of_air, 100U);
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

TEST(Air, NeedsTheFiguresThatItIsComputedFrom) {
  SensorConfig config = in_air(fog(100));
  config.noise.signal = {};
  EXPECT_THROW(make_lidar(config), InputError);
  config.noise.air = {};
  config.noise.blooming.share = 0.01;
  EXPECT_THROW(make_lidar(config), InputError);
  config = in_air(rain(5));
  config.noise.beam.width_deg = 0.0;
  EXPECT_THROW(make_lidar(config), InputError);
}

}  // namespace
}  // namespace lidarena::sensor
