// SPDX-License-Identifier: BSD-3-Clause
// Times of the single steps of arena_slam on scans of a room with pillars: 20,000 points on 4 lines
// in a pattern that does not repeat (Mid-360), and 128 x 1024 points (OS0-128).
#include <benchmark/benchmark.h>

#include <cmath>
#include <numbers>

#include "lidarena/base/random.hpp"
#include "lidarena/estimation/deskew.hpp"
#include "lidarena/loop/icp.hpp"
#include "lidarena/odometry/arena_slam/features.hpp"
#include "lidarena/odometry/arena_slam/keyframes.hpp"
#include "lidarena/odometry/arena_slam/registration.hpp"

namespace lidarena::odometry::arena_slam {
namespace {

using Eigen::Vector3d;

struct Box {
  Eigen::Array3d low, high;
};
const Box kRoom{{-10.0, -7.5, -1.5}, {10.0, 7.5, 2.5}};
const Box kPillars[] = {{{3.0, 3.0, -1.5}, {3.8, 4.0, 2.5}},
                        {{-5.0, 2.0, -1.5}, {-4.2, 2.8, 2.5}},
                        {{-4.0, -5.0, -1.5}, {-3.0, -4.2, 1.0}},
                        {{5.5, -3.5, -1.5}, {6.5, -2.5, 2.5}}};

double cast(const Vector3d& origin, const Vector3d& beam) {
  const auto slabs = [&](const Box& box) {
    const Eigen::Array3d a = (box.low - origin.array()) / beam.array();
    const Eigen::Array3d b = (box.high - origin.array()) / beam.array();
    return std::pair{a.min(b).maxCoeff(), a.max(b).minCoeff()};
  };
  double range = slabs(kRoom).second;
  for (const Box& pillar : kPillars) {
    const auto [enter, leave] = slabs(pillar);
    if (enter < leave && enter > 0.0) range = std::min(range, enter);
  }
  return range;
}

/// Scan of a sensor at rest at `place`.
Scan scan_from(const Vector3d& place, bool spinning, std::uint64_t seed) {
  const CounterRandom random(seed);
  Scan scan;
  const int count = spinning ? 128 * 1024 : 20'000;
  for (int i = 0; i < count; ++i) {
    const int ring = spinning ? i % 128 : i % 4;
    const double share =
        static_cast<double>(i) / count + (spinning ? 0.0 : 0.618 * static_cast<double>(seed));
    const double azimuth = 2.0 * std::numbers::pi * (spinning ? share : 9.79 * share);
    const double wave = 2.0 * std::abs(std::fmod(203.17 * share + 0.25 * ring, 1.0) - 0.5);
    const double elevation =
        (spinning ? 90.0 * (0.5 - ring / 127.0) : -7.0 + 59.0 * wave) * std::numbers::pi / 180.0;
    const Vector3d beam(std::cos(elevation) * std::cos(azimuth),
                        std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
    const double noise = 0.02 * random.normals(static_cast<std::uint64_t>(i))[0];
    Point point;
    point.position = ((cast(place, beam) + noise) * beam).cast<float>();
    point.ring = static_cast<std::uint16_t>(ring);
    scan.points.push_back(point);
  }
  return scan;
}

/// A scan, and the keyframes of an earlier walk through the room.
struct Scene {
  Config config;
  FeatureRule rule;
  Scan scan;
  std::vector<Eigen::Vector3f> points;
  std::vector<map::Keyframe> keyframes;
  std::vector<std::uint32_t> chosen;

  explicit Scene(bool spinning) {
    LidarInfo lidar;
    lidar.kind = spinning ? "spinning" : "rosette";
    lidar.columns = spinning ? 1024 : 0;
    lidar.max_range_m = 50.0;
    config = settings_for(lidar);
    rule = feature_rule(lidar, config);
    for (int i = 0; i < 20; ++i) {
      const Vector3d place(-6.0 + 0.5 * i, 0.5 * std::sin(i), 0.0);
      const Scan seen = scan_from(place, spinning, static_cast<std::uint64_t>(i) + 2);
      keyframes.push_back({from_seconds(i), make_pose(Eigen::Matrix3d::Identity(), place),
                           map::thinned(features_of(seen), feature_voxels(config)), 0});
      chosen.push_back(static_cast<std::uint32_t>(i));
    }
    scan = scan_from(Vector3d::Zero(), spinning, 1);
    points = estimation::positions(scan);
  }
  map::Features features_of(const Scan& seen) const {
    return extract_features(estimation::project(seen, estimation::positions(seen), rule.layout),
                            rule, Parallel(1));
  }
};

const Scene& scene(const benchmark::State& state) {
  static const Scene livox(false);
  static const Scene ouster(true);
  return state.range(0) == 0 ? livox : ouster;
}

void project_points(benchmark::State& state) {
  const Scene& s = scene(state);
  for (auto _ : state)
    benchmark::DoNotOptimize(estimation::project(s.scan, s.points, s.rule.layout));
}

void extract(benchmark::State& state) {
  const Scene& s = scene(state);
  const estimation::RangeImage image = estimation::project(s.scan, s.points, s.rule.layout);
  map::Features features;
  for (auto _ : state) features = extract_features(image, s.rule, Parallel(1));
  state.counters["edges"] = static_cast<double>(features.edges.size());
  state.counters["surfaces"] = static_cast<double>(features.surfaces.size());
}

void thin_features(benchmark::State& state) {
  const Scene& s = scene(state);
  const map::Features raw = s.features_of(s.scan);
  map::Features features;
  for (auto _ : state) features = map::thinned(raw, feature_voxels(s.config));
  state.counters["edges"] = static_cast<double>(features.edges.size());
  state.counters["surfaces"] = static_cast<double>(features.surfaces.size());
}

void build_submap(benchmark::State& state) {
  const Scene& s = scene(state);
  std::size_t points = 0;
  for (auto _ : state) {
    map::FeatureMap submap(feature_voxels(s.config));
    submap.select(s.keyframes, s.chosen);
    points = submap.size();
  }
  state.counters["points"] = static_cast<double>(points);
}

/// As during a flight: adds one keyframe and removes one.
void follow_submap(benchmark::State& state) {
  const Scene& s = scene(state);
  const std::vector<std::uint32_t> without_last(s.chosen.begin(), s.chosen.end() - 1);
  const std::vector<std::uint32_t> without_first(s.chosen.begin() + 1, s.chosen.end());
  map::FeatureMap submap(feature_voxels(s.config));
  bool forward = false;
  for (auto _ : state) {
    submap.select(s.keyframes, forward ? without_first : without_last);
    forward = !forward;
  }
  state.counters["points"] = static_cast<double>(submap.size());
}

void register_scan(benchmark::State& state) {
  const Scene& s = scene(state);
  map::FeatureMap submap(feature_voxels(s.config));
  submap.select(s.keyframes, s.chosen);
  const map::Features features = map::thinned(s.features_of(s.scan), feature_voxels(s.config));
  const Pose guess = make_pose(Eigen::Matrix3d::Identity(), {0.03, -0.02, 0.01});
  Registration found;
  const Parallel parallel(1);
  for (auto _ : state) found = register_features(features, submap, guess, {}, parallel);
  state.counters["iterations"] = found.iterations;
  state.counters["error_mm"] = 1e3 * found.map_from_lidar.translation().norm();
}

void verify_loop(benchmark::State& state) {
  const Scene& s = scene(state);
  std::vector<Eigen::Vector3f> target;
  for (const map::Keyframe& keyframe : s.keyframes) {
    for (const Eigen::Vector3f& p : keyframe.features.surfaces)
      target.push_back(keyframe.world_from_lidar.cast<float>() * p);
  }
  map::KdTree tree;
  tree.build(target);
  const map::Features source = map::thinned(s.features_of(s.scan), feature_voxels(s.config));
  const Pose guess = make_pose(Eigen::Matrix3d::Identity(), {0.5, -0.4, 0.1});
  const Parallel parallel(1);
  for (auto _ : state)
    benchmark::DoNotOptimize(loop::align_clouds(source.surfaces, tree, guess, parallel));
}

constexpr auto kUnit = benchmark::kMillisecond;
BENCHMARK(project_points)->ArgName("spinning")->Arg(0)->Arg(1)->Unit(kUnit);
BENCHMARK(extract)->ArgName("spinning")->Arg(0)->Arg(1)->Unit(kUnit);
BENCHMARK(thin_features)->ArgName("spinning")->Arg(0)->Arg(1)->Unit(kUnit);
BENCHMARK(build_submap)->ArgName("spinning")->Arg(0)->Arg(1)->Unit(kUnit);
BENCHMARK(follow_submap)->ArgName("spinning")->Arg(0)->Arg(1)->Unit(kUnit);
BENCHMARK(register_scan)->ArgName("spinning")->Arg(0)->Arg(1)->Unit(kUnit);
BENCHMARK(verify_loop)->ArgName("spinning")->Arg(0)->Arg(1)->Unit(kUnit);

}  // namespace
}  // namespace lidarena::odometry::arena_slam
