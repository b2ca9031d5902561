// SPDX-License-Identifier: BSD-3-Clause
// Times of the single steps of KISS-ICP on one thread, for a scan during a flight through a
// box-shaped room. Also compares the map's nearest-neighbor search with nanoflann on the same
// points.
#include <benchmark/benchmark.h>

#ifdef LIDARENA_HAVE_NANOFLANN
#include <nanoflann.hpp>
#endif

#include <cmath>
#include <vector>

#include "lidarena/base/random.hpp"
#include "lidarena/base/so3.hpp"
#include "lidarena/estimation/deskew.hpp"
#include "lidarena/estimation/least_squares.hpp"
#include "lidarena/odometry/kiss_icp/kiss_icp.hpp"

namespace lidarena::odometry::kiss_icp {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kNoise_m = 0.02;
constexpr double kPeriod_s = 0.1;
const Vector3d kHalfRoom(10.0, 7.5, 2.0);  // m; without pillars

/// Circular motion around the middle of the room with 2 m/s and 60 deg/s.
Pose pose_at(double seconds) {
  const double angle = 1.05 * seconds;
  return make_pose(so3::exp({0.0, 0.0, angle}), {2.0 * std::sin(angle), -2.0 * std::cos(angle), 0});
}

double range_to_walls(const Vector3d& origin, const Vector3d& beam) {
  double range = 1e9;
  for (int k = 0; k < 3; ++k) {
    const double gap = kHalfRoom[k] - std::copysign(origin[k], origin[k] * beam[k]);
    range = std::min(range, gap / std::max(1e-9, std::abs(beam[k])));
  }
  return range;
}

/// `count` beams in all azimuths, elevations -7 to 52 deg, in a pattern that does not repeat.
Scan scan_at(int index, std::size_t count) {
  const CounterRandom random(1, static_cast<std::uint32_t>(index));
  Scan scan;
  scan.stamp = from_seconds(kPeriod_s * index);
  for (std::size_t i = 0; i < count; ++i) {
    const double part = static_cast<double>(i) / static_cast<double>(count);
    const Pose pose = pose_at(kPeriod_s * (index + part));
    const auto shot = static_cast<double>(i) + static_cast<double>(index) * 1e5;
    const double azimuth = 2.399963 * shot;
    const double elevation = 0.90 * std::fmod(0.414214 * shot, 1.0) - 0.122;
    const Vector3d beam(std::cos(elevation) * std::cos(azimuth),
                        std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
    const double range =
        range_to_walls(pose.translation(), pose.linear() * beam) + kNoise_m * random.normals(i)[0];
    Point& point = scan.points.emplace_back();
    point.position = (range * beam).cast<float>();
    point.dt_ns = static_cast<std::int32_t>(1e9 * kPeriod_s * part);
  }
  return scan;
}

constexpr CellOrder kCells{map::VoxelRounding::kTruncate, 19349663U};  // of v0.2

/// Inputs of the steps: a map of 20 scans, and the next scan in each stage of processing.
struct Stage {
  static constexpr int kScans = 20;
  Config config;
  Parallel parallel{1};
  Scan scan;
  Points points, map_points, keypoints;
  map::VoxelHashMap map;
  Pose guess;
  Points in_map;

  explicit Stage(std::size_t count)
      : config(indoor(LidarInfo{})),
        scan(scan_at(kScans, count)),
        points(in_range(estimation::positions(scan), config)),
        map_points(thin_for_map(points)),
        keypoints(thin_for_registration(map_points)),
        map(empty_map()),
        guess(pose_at(kPeriod_s * kScans)),
        in_map(transformed(guess, map_points)) {
    for (int i = 0; i < kScans; ++i) {
      for (const Point& point : scan_at(i, count).points) {
        const Pose pose = pose_at(kPeriod_s * i + 1e-9 * point.dt_ns);
        map.insert((pose * point.position.cast<double>()).cast<float>());
      }
    }
  }
  map::VoxelHashMap empty_map() const {
    return map::VoxelHashMap(
        {config.voxel_size(), config.max_points_per_voxel, 0.0, kCells.rounding});
  }
  Points thin_for_map(const Points& all) const {
    return thin(all, kMapThinning * config.voxel_size(), kCells);
  }
  Points thin_for_registration(const Points& all) const {
    return thin(all, kKeypointThinning * config.voxel_size(), kCells);
  }
};

const Stage& stage(std::int64_t count) {
  static const Stage mid360(20'000);
  static const Stage os0(262'144);
  return count == 20'000 ? mid360 : os0;
}

void per_item(benchmark::State& state, std::size_t items) {
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(items));
}

void deskew_scan(benchmark::State& state) {
  const Stage& s = stage(state.range(0));
  const se3::Vector6 twist = se3::Vector6::Constant(0.5);
  for (auto _ : state)
    benchmark::DoNotOptimize(estimation::deskew(s.scan, twist, s.scan.stamp, s.parallel));
  per_item(state, s.scan.points.size());
}

void gate_scan(benchmark::State& state) {
  const Stage& s = stage(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(in_range(s.points, s.config));
  per_item(state, s.points.size());
}

void thin_twice(benchmark::State& state) {
  const Stage& s = stage(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(s.thin_for_registration(s.thin_for_map(s.points)));
  per_item(state, s.points.size());
}

void register_keypoints(benchmark::State& state) {
  const Stage& s = stage(state.range(0));
  for (auto _ : state) {
    const auto found = register_points(s.keypoints, s.map, s.guess,
                                       icp_limits(0.2, 0.2 / 3.0, s.config), s.parallel);
    state.counters["iterations"] = found.iterations;
    state.counters["keypoints"] = static_cast<double>(s.keypoints.size());
  }
}

void solve(benchmark::State& state) {
  estimation::NormalEquations<6> equations;
  for (int k = 0; k < 6; ++k)
    equations.add<1>(Eigen::Matrix<double, 1, 6>::Random(), Eigen::Matrix<double, 1, 1>(0.1), 1.0);
  for (auto _ : state) benchmark::DoNotOptimize(equations.solve());
}

void insert_into_map(benchmark::State& state) {
  const Stage& s = stage(state.range(0));
  for (auto _ : state) {
    state.PauseTiming();
    map::VoxelHashMap map = s.empty_map();
    state.ResumeTiming();
    map.insert(s.in_map);
  }
  per_item(state, s.in_map.size());
}

BENCHMARK(deskew_scan)->Arg(20'000)->Arg(262'144)->Unit(benchmark::kMillisecond);
BENCHMARK(gate_scan)->Arg(20'000)->Arg(262'144)->Unit(benchmark::kMillisecond);
BENCHMARK(thin_twice)->Arg(20'000)->Arg(262'144)->Unit(benchmark::kMillisecond);
BENCHMARK(register_keypoints)->Arg(20'000)->Arg(262'144)->Unit(benchmark::kMillisecond);
BENCHMARK(solve)->Unit(benchmark::kMicrosecond);
BENCHMARK(insert_into_map)->Arg(20'000)->Arg(262'144)->Unit(benchmark::kMillisecond);

/// Nearest point of the map to each point of the scan, within 0.5 m (the voxel size).
constexpr float kReach_m = 0.5F;

void nearest_in_the_hash_map(benchmark::State& state) {
  const Stage& s = stage(20'000);
  for (auto _ : state) {
    for (const Vector3f& query : s.in_map) benchmark::DoNotOptimize(s.map.nearest(query, kReach_m));
  }
  per_item(state, s.in_map.size());
  state.counters["map_points"] = static_cast<double>(s.map.size());
}
BENCHMARK(nearest_in_the_hash_map)->Unit(benchmark::kMillisecond);

#ifdef LIDARENA_HAVE_NANOFLANN
struct Cloud {
  std::vector<Vector3f> points;
  std::size_t kdtree_get_point_count() const { return points.size(); }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return points[i][static_cast<Eigen::Index>(axis)];
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};
using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Cloud>, Cloud,
                                                 3, std::uint32_t>;

void nearest_in_nanoflann(benchmark::State& state) {
  const Stage& s = stage(20'000);
  const Cloud cloud{s.map.points()};
  const Tree tree(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(10));
  for (auto _ : state) {
    for (const Vector3f& query : s.in_map) {
      std::uint32_t index = 0;
      float squared_distance = kReach_m * kReach_m;
      benchmark::DoNotOptimize(tree.knnSearch(query.data(), 1, &index, &squared_distance));
    }
  }
  per_item(state, s.in_map.size());
}
BENCHMARK(nearest_in_nanoflann)->Unit(benchmark::kMillisecond);

void build_nanoflann(benchmark::State& state) {
  const Cloud cloud{stage(20'000).map.points()};
  for (auto _ : state)
    benchmark::DoNotOptimize(Tree(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(10)));
  per_item(state, cloud.points.size());
}
BENCHMARK(build_nanoflann)->Unit(benchmark::kMillisecond);
#endif

}  // namespace
}  // namespace lidarena::odometry::kiss_icp
