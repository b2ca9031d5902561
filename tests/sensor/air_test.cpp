// SPDX-License-Identifier: BSD-3-Clause
// Fog, dust and rain, compared with closed forms and slow sums.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "lidarena/base/angle.hpp"
#include "lidarena/sensor/air.hpp"

#include "tests/sensor/surroundings.hpp"

namespace lidarena::sensor {
namespace {

using Eigen::Vector3d;
using namespace testing;
using namespace world::testing;

Air air_of(const SensorConfig& config) {
  return {config.noise,
          SignalModel(config.noise.signal),
          config.min_range_m,
          config.max_range_m,
          "a",
          1};
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
