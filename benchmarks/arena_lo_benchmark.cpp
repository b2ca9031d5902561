// SPDX-License-Identifier: BSD-3-Clause
// Times of the single steps of arena_lo with its own settings, in a box of 16 x 12 x 4 m: slices,
// averages, measurement, filter and smoother, whole registration, insertion; and a solution of
// CT-ICP's elastic scan.
#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "benchmarks/box_scan.hpp"
#include "lidarena/base/so3.hpp"
#include "lidarena/odometry/arena_lo/registration.hpp"
#include "lidarena/odometry/ct_icp/alignment.hpp"

namespace lidarena::odometry::arena_lo {
namespace {

using box::positions;
using box::scan_of;

const Config& config() {
  static const Config made = settings_for(LidarInfo{});
  return made;
}

std::vector<Slice> slices(const Scan& scan) {
  return slices_of(scan, estimation::times_of(scan, from_seconds(0.1)), config().slice_s, config());
}

map::LocalPlanes map_of_box() {
  map::LocalPlanes made(config().map.options());
  made.insert(positions(scan_of(400'000, 1)), Eigen::Vector3f(0, 0, 0));
  return made;
}

/// At rest, a little off the true pose.
Known before() {
  Known known{{}, Time{-1'000'000}};
  known.estimate.state.pose = make_pose(so3::exp({0.01, 0.0, 0.02}), {0.02, 0.0, 0.01});
  known.estimate.covariance.diagonal().setConstant(1e-3);
  return known;
}

void divide_into_slices(benchmark::State& state) {
  const Scan scan = scan_of(static_cast<std::size_t>(state.range(0)), 2);
  for (auto _ : state) benchmark::DoNotOptimize(slices(scan));
}
BENCHMARK(divide_into_slices)->Arg(20'000)->Arg(131'072)->Unit(benchmark::kMillisecond);

void average_slices(benchmark::State& state) {
  const auto parts = slices(scan_of(static_cast<std::size_t>(state.range(0)), 2));
  const Parallel one(1);
  const int most = config().max_scan_points / static_cast<int>(parts.size());
  for (auto _ : state) {
    for (const Slice& slice : parts)
      benchmark::DoNotOptimize(averages(slice, {}, most, config(), one));
  }
}
BENCHMARK(average_slices)->Arg(20'000)->Arg(131'072)->Unit(benchmark::kMillisecond);

void measure_points(benchmark::State& state) {
  const map::LocalPlanes map = map_of_box();
  const auto points = positions(scan_of(static_cast<std::size_t>(config().max_scan_points), 2));
  const Parallel one(1);
  for (auto _ : state)
    benchmark::DoNotOptimize(
        measure(points, before().estimate, config().kernel_scale_m, map, config(), one));
}
BENCHMARK(measure_points)->Unit(benchmark::kMillisecond);

void filter_and_smooth(benchmark::State& state) {
  const auto parts = slices(scan_of(20'000, 2));
  for (auto _ : state) {
    const Steps steps = coast(before(), parts, from_seconds(0.1), config());
    Motion motion = estimation::smoothed(steps);
    benchmark::DoNotOptimize(motion);
  }
}
BENCHMARK(filter_and_smooth)->Unit(benchmark::kMillisecond);

void register_scan(benchmark::State& state) {
  const map::LocalPlanes map = map_of_box();
  const auto parts = slices(scan_of(static_cast<std::size_t>(state.range(0)), 2));
  const Parallel one(1);
  for (auto _ : state)
    benchmark::DoNotOptimize(
        register_slices(before(), parts, from_seconds(0.1), map, config(), one));
}
BENCHMARK(register_scan)->Arg(20'000)->Arg(131'072)->Unit(benchmark::kMillisecond);

void insert_scan(benchmark::State& state) {
  map::LocalPlanes grown = map_of_box();
  const auto points = positions(scan_of(static_cast<std::size_t>(state.range(0)), 3));
  for (auto _ : state) grown.insert(points, Eigen::Vector3f(0, 0, 0));
}
BENCHMARK(insert_scan)->Arg(20'000)->Arg(131'072)->Unit(benchmark::kMillisecond);

void levenberg_marquardt(benchmark::State& state) {
  std::vector<ct_icp::ElasticMatch> matches;
  for (const Slice& slice : slices(scan_of(2'000, 2))) {
    for (const Slice::Point& point : slice.points) {
      ct_icp::ElasticMatch& match = matches.emplace_back();
      match.point = point.position.cast<double>();
      match.alpha = 10.0 * (to_seconds(slice.middle) + double{point.seconds});
      match.anchor = match.point;
      Eigen::Index axis = 0;
      (match.point.array().abs() / box::kHalf).maxCoeff(&axis);
      match.normal = Eigen::Vector3d::Unit(axis);
    }
  }
  const auto guess = ct_icp::ElasticMotion::still(before().estimate.state.pose);
  const Parallel one(1);
  for (auto _ : state) benchmark::DoNotOptimize(ct_icp::align({matches, {}, 0.1}, guess, 20, one));
}
BENCHMARK(levenberg_marquardt)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lidarena::odometry::arena_lo
