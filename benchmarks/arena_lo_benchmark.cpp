// SPDX-License-Identifier: BSD-3-Clause
// Times of the single steps of arena_lo with its own settings, in a box of 16 x 12 x 4 m:
// downsampling, keypoints, neighbor search and description, insertion; and of both elastic solvers:
// one Gauss-Newton step of arena_lo, and a solution of CT-ICP.
#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "lidarena/base/random.hpp"
#include "lidarena/base/so3.hpp"
#include "lidarena/odometry/arena_lo/registration.hpp"

namespace lidarena::odometry::arena_lo {
namespace {

/// Points of a scan at rest in the middle of the box, uniform over the sphere, with 2 cm of noise.
std::vector<TimedPoint> scan_of(std::size_t count, std::uint64_t seed) {
  const CounterRandom random(seed);
  const Eigen::Array3d half(8.0, 6.0, 2.0);
  std::vector<TimedPoint> points;
  for (std::size_t i = 0; i < count; ++i) {
    const double z = 2.0 * random.uniform(i, 0) - 1.0;
    const double azimuth = 2.0 * M_PI * random.uniform(i, 1);
    const double radius = std::sqrt(1.0 - z * z);
    const Eigen::Vector3d beam(radius * std::cos(azimuth), radius * std::sin(azimuth), z);
    const double range = (half / beam.array().abs()).minCoeff() + 0.02 * random.normals(i, 2)[0];
    const double alpha = static_cast<double>(i) / static_cast<double>(count);
    points.push_back({(range * beam).cast<float>(), static_cast<float>(alpha)});
  }
  return points;
}

const Config& config() {
  static const Config made = settings_for(LidarInfo{});
  return made;
}

const map::VoxelHashMap& map() {
  static const map::VoxelHashMap filled = [] {
    map::VoxelHashMap made({config().map.voxel_size_m, config().map.max_points_per_voxel,
                            config().map.min_point_spacing_m});
    for (const TimedPoint& point : scan_of(400'000, 1)) made.insert(point.position);
    return made;
  }();
  return filled;
}

std::vector<TimedPoint> keypoints() {
  return sample_keypoints(scan_of(20'000, 2), config().sampling);
}

void thin_scan(benchmark::State& state) {
  const auto points = scan_of(static_cast<std::size_t>(state.range(0)), 2);
  for (auto _ : state) benchmark::DoNotOptimize(thin(points, config().sampling.scan_voxel_size_m));
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(thin_scan)->Arg(20'000)->Arg(262'144)->Unit(benchmark::kMillisecond);

void choose_keypoints(benchmark::State& state) {
  const auto frame = scan_of(20'000, 2);
  for (auto _ : state) benchmark::DoNotOptimize(sample_keypoints(frame, config().sampling));
}
BENCHMARK(choose_keypoints)->Unit(benchmark::kMillisecond);

void search_neighbors(benchmark::State& state) {
  const auto queries = keypoints();
  std::vector<map::Neighbor> near(20);
  for (auto _ : state) {
    for (const TimedPoint& query : queries)
      benchmark::DoNotOptimize(map().nearest(query.position, 0.4F, near));
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(queries.size()));
}
BENCHMARK(search_neighbors)->Unit(benchmark::kMillisecond);

void describe_neighbors(benchmark::State& state) {
  std::vector<map::Neighbor> near(20);
  near.resize(map().nearest(keypoints().front().position, 0.4F, near));
  for (auto _ : state) benchmark::DoNotOptimize(map::describe(near));
}
BENCHMARK(describe_neighbors);

/// Matches of a scan with the planes of the box.
std::vector<estimation::ElasticMatch> matches() {
  std::vector<estimation::ElasticMatch> made;
  for (const TimedPoint& keypoint : keypoints()) {
    estimation::ElasticMatch match;
    match.point = keypoint.position.cast<double>();
    match.alpha = keypoint.alpha;
    match.anchor = match.point;
    const Eigen::Array3d share = match.point.array().abs() / Eigen::Array3d(8.0, 6.0, 2.0);
    Eigen::Index axis = 0;
    share.maxCoeff(&axis);
    match.normal = Eigen::Vector3d::Unit(axis);
    made.push_back(match);
  }
  return made;
}

estimation::ElasticMotion guess(std::int64_t segments) {
  return estimation::ElasticMotion::still(make_pose(so3::exp({0.01, 0.0, 0.02}), {0.02, 0.0, 0.01}),
                                          static_cast<int>(segments));
}

void gauss_newton_step(benchmark::State& state) {
  const auto made = matches();
  const Parallel one(1);
  for (auto _ : state)
    benchmark::DoNotOptimize(
        estimation::gauss_newton_step({made, {}, 0.05}, guess(state.range(0)), one));
}
BENCHMARK(gauss_newton_step)->Arg(1)->Arg(3)->Unit(benchmark::kMillisecond);

void levenberg_marquardt(benchmark::State& state) {
  const auto made = matches();
  const Parallel one(1);
  for (auto _ : state)
    benchmark::DoNotOptimize(
        estimation::align_by_levenberg_marquardt({made, {}, 0.1}, guess(1), 20, one));
}
BENCHMARK(levenberg_marquardt)->Unit(benchmark::kMillisecond);

void insert_scan(benchmark::State& state) {
  const auto frame = thin(scan_of(20'000, 3), config().sampling.scan_voxel_size_m);
  map::VoxelHashMap grown = [] {
    map::VoxelHashMap made({config().map.voxel_size_m, config().map.max_points_per_voxel,
                            config().map.min_point_spacing_m});
    for (const TimedPoint& point : scan_of(400'000, 1)) made.insert(point.position);
    return made;
  }();
  for (auto _ : state) {
    for (const TimedPoint& point : frame) grown.insert(point.position);
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(frame.size()));
}
BENCHMARK(insert_scan)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lidarena::odometry::arena_lo
