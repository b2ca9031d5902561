// SPDX-License-Identifier: BSD-3-Clause
// Times of the single steps of arena_lio with its own settings, in a box of 16 x 12 x 4 m:
// propagation, de-skewing, averages, the iterated update and one evaluation of it, whether a
// direction is open, insertion, and a scan as a whole.
#include <benchmark/benchmark.h>

#include <cmath>
#include <functional>
#include <vector>

#include "benchmarks/box_scan.hpp"
#include "lidarena/base/so3.hpp"
#include "lidarena/estimation/imu_track.hpp"
#include "lidarena/map/voxel_filter.hpp"
#include "lidarena/odometry/arena_lio/arena_lio.hpp"
#include "lidarena/odometry/arena_lio/plane_residuals.hpp"

namespace lidarena::odometry::arena_lio {
namespace {

using box::positions;
using box::scan_of;
using estimation::InertialState;

constexpr double kImuStep = 0.005;  // s
constexpr double kScan = 0.1;       // s

const Config& config() {
  static const Config made = settings_for(LidarInfo{});
  return made;
}

std::vector<Eigen::Vector3f> averages(const std::vector<Eigen::Vector3f>& points) {
  return map::evenly(map::voxel_means(points, config().scan_voxel_size_m, map::GridAxes::kRotated),
                     config().max_scan_points);
}

map::LocalPlanes map_of_box() {
  map::LocalPlanes made(config().map.options());
  made.insert(positions(scan_of(400'000, 1)), Eigen::Vector3f(0, 0, 0));
  return made;
}

/// At rest, a centimeter or two and a hundredth of a radian off the true pose.
estimation::StateEstimate before() {
  estimation::StateEstimate estimate;
  estimate.state.nav.world_from_imu =
      make_pose(so3::exp({0.01, 0.0, 0.02}), Eigen::Vector3d(0.02, 0.0, 0.01));
  estimate.covariance = InertialState::Matrix::Identity() * 1e-4;
  return estimate;
}

estimation::ImuTrack track_at_rest() {
  estimation::ImuTrack track;
  for (int i = 0; i < std::lround(kScan / kImuStep); ++i)
    track.push_back({.begin = from_seconds(kImuStep * i)});
  return track;
}

void propagate_scan(benchmark::State& state) {
  for (auto _ : state) {
    estimation::StateEstimate estimate = before();
    for (int i = 0; i < std::lround(kScan / kImuStep); ++i) {
      const InertialState::Matrix f = estimation::propagate(
          estimate.state, Eigen::Vector3d(0.1, 0.2, 0.3), Eigen::Vector3d(0.0, 0.0, 9.81), kImuStep,
          estimation::Integration::kSecondOrder);
      estimate.covariance = f * estimate.covariance * f.transpose() +
                            estimation::step_noise(estimation::kCoastingNoise, kImuStep);
    }
    benchmark::DoNotOptimize(estimate);
  }
}
BENCHMARK(propagate_scan)->Unit(benchmark::kMillisecond);

void deskew_scan(benchmark::State& state) {
  const Scan scan = scan_of(static_cast<std::size_t>(state.range(0)), 2);
  const estimation::ImuTrack track = track_at_rest();
  const Parallel one(1);
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        estimation::deskew(scan, track, Pose::Identity(), Pose::Identity(), one));
  }
}
BENCHMARK(deskew_scan)->Arg(20'000)->Arg(131'072)->Unit(benchmark::kMillisecond);

void average_scan(benchmark::State& state) {
  const auto points = positions(scan_of(static_cast<std::size_t>(state.range(0)), 2));
  for (auto _ : state) benchmark::DoNotOptimize(averages(points));
}
BENCHMARK(average_scan)->Arg(20'000)->Arg(131'072)->Unit(benchmark::kMillisecond);

void evaluate_residuals(benchmark::State& state) {
  const map::LocalPlanes map = map_of_box();
  const auto points = averages(positions(scan_of(131'072, 2)));
  const std::vector<Eigen::Vector3f> seen_from(points.size(), Eigen::Vector3f::Zero());
  const Parallel one(1);
  PlaneResiduals residuals(points, seen_from, map, 0.01, true, config(), one);
  for (auto _ : state) benchmark::DoNotOptimize(residuals(before().state, true));
  state.counters["points"] = static_cast<double>(points.size());
}
BENCHMARK(evaluate_residuals)->Unit(benchmark::kMillisecond);

void judge_directions(benchmark::State& state) {
  const map::LocalPlanes map = map_of_box();
  const std::vector<Eigen::Vector3f> points = averages(positions(scan_of(20'000, 2)));
  for (auto _ : state) {
    const auto contacts = contacts_of(points, {0, 0, 0}, map, config().kernel_scale_m);
    benchmark::DoNotOptimize(leaves_a_direction_open(contacts, 5.0));
  }
}
BENCHMARK(judge_directions)->Unit(benchmark::kMillisecond);

void update(benchmark::State& state) {
  const map::LocalPlanes map = map_of_box();
  const auto points = averages(positions(scan_of(static_cast<std::size_t>(state.range(0)), 2)));
  const std::vector<Eigen::Vector3f> seen_from(points.size(), Eigen::Vector3f::Zero());
  const Parallel one(1);
  for (auto _ : state) {
    PlaneResiduals residuals(points, seen_from, map, 0.01, true, config(), one);
    benchmark::DoNotOptimize(estimation::iterated_update(
        before(), std::ref(residuals),
        {config().max_iterations + residuals.narrowing(), 1e-3, config().point_variance_m2}));
  }
  state.counters["points"] = static_cast<double>(points.size());
}
BENCHMARK(update)->Arg(20'000)->Arg(131'072)->Unit(benchmark::kMillisecond);

void insert_scan(benchmark::State& state) {
  map::LocalPlanes grown = map_of_box();
  const auto points = positions(scan_of(static_cast<std::size_t>(state.range(0)), 3));
  for (auto _ : state) grown.insert(points, Eigen::Vector3f(0, 0, 0));
}
BENCHMARK(insert_scan)->Arg(20'000)->Arg(131'072)->Unit(benchmark::kMillisecond);

/// Scans at rest with their IMU samples, 200 in a second.
void register_scan(benchmark::State& state) {
  LidarInfo lidar;
  lidar.rate_hz = 1.0 / kScan;
  ArenaLio odometry(config(), lidar, ImuInfo{}, Parallel(1));
  Scan scan = scan_of(static_cast<std::size_t>(state.range(0)), 2);
  Time sampled{0};
  for (auto _ : state) {
    state.PauseTiming();
    for (const Time end = scan.stamp + from_seconds(kScan); sampled <= end;
         sampled += from_seconds(kImuStep))
      odometry.register_imu({sampled, Eigen::Vector3d::Zero(), Eigen::Vector3d(0.0, 0.0, 9.81)});
    state.ResumeTiming();
    benchmark::DoNotOptimize(odometry.register_scan(scan));
    scan.stamp += from_seconds(kScan);
  }
}
BENCHMARK(register_scan)->Arg(20'000)->Arg(131'072)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lidarena::odometry::arena_lio
