// SPDX-License-Identifier: BSD-3-Clause
// The incremental k-d tree under the load of an odometry: scans of a room from a moving sensor,
// averaged in voxels of 0.2 m. For comparison: a static tree that is rebuilt for each scan
// (nanoflann, if it was found), our voxel map and our map of planes.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <map>
#include <vector>

#include "lidarena/base/random.hpp"
#include "lidarena/map/kd_tree.hpp"
#include "lidarena/map/plane_map.hpp"
#include "lidarena/map/voxel_filter.hpp"
#include "lidarena/map/voxel_hash_map.hpp"

#ifdef LIDARENA_HAVE_NANOFLANN
#include <nanoflann.hpp>
#endif

namespace lidarena {
namespace {

constexpr float kVoxel = 0.2F;  // m
constexpr std::size_t kNeighbors = 5;
using Points = std::vector<Eigen::Vector3f>;

/// Scan `index` of a walk through a room of 2 `half` m: 20,000 beams with 2 cm of range noise.
Points scan_of(int index, const Eigen::Vector3f& half) {
  SequentialRandom random(static_cast<std::uint64_t>(index), 1);
  const float t = 0.02F * static_cast<float>(index);
  const Eigen::Vector3f sensor =
      half.cwiseProduct(Eigen::Vector3f(0.7F * std::cos(t), 0.7F * std::sin(2.0F * t), 0.0F));
  Points points;
  for (int i = 0; i < 20'000; ++i) {
    const double x = random.normal();
    const double y = random.normal();
    const Eigen::Vector3f beam = Eigen::Vector3d(x, y, random.normal()).normalized().cast<float>();
    const Eigen::Array3f far = (beam.array() > 0.0F).select(half.array(), -half.array());
    const float range = ((far - sensor.array()) / beam.array()).minCoeff();
    points.push_back(sensor + (range + 0.02F * static_cast<float>(random.normal())) * beam);
  }
  return map::voxel_means(points, kVoxel);
}

/// The scans of a walk, computed once for each room; `length` is the room's length, m.
const std::vector<Points>& scans(int length) {
  static std::map<int, std::vector<Points>> rooms;
  std::vector<Points>& room = rooms[length];
  const auto half = static_cast<float>(length) / 2.0F;
  for (int i = static_cast<int>(room.size()); i < 400; ++i) {
    room.push_back(scan_of(i, {half, 0.75F * half, 2.0F}));
  }
  return room;
}

void add(const Points& scan, map::KdTree& tree) {
  for (const Eigen::Vector3f& point : scan) tree.insert_downsampled(point, kVoxel);
}

map::KdTree walked(int length) {
  map::KdTree tree;
  for (const Points& scan : scans(length)) add(scan, tree);
  return tree;
}

double percentile(std::vector<double>& values, double share) {
  const auto place = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + place, values.end());
  return values[static_cast<std::size_t>(place)];
}

/// Time of one insertion and of all insertions of a scan; re-balancing shows in the high
/// percentiles.
void kd_tree_insertion(benchmark::State& state) {
  using Clock = std::chrono::steady_clock;
  const auto since = [](Clock::time_point start) {
    return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
  };
  const std::vector<Points>& walk = scans(static_cast<int>(state.range(0)));
  std::vector<double> each;
  std::vector<double> whole;
  for (auto _ : state) {
    map::KdTree tree;
    for (const Points& scan : walk) {
      const auto begin = Clock::now();
      for (const Eigen::Vector3f& point : scan) {
        const auto start = Clock::now();
        tree.insert_downsampled(point, kVoxel);
        each.push_back(since(start));
      }
      whole.push_back(since(begin));
    }
    state.counters["map_points"] = static_cast<double>(tree.size());
  }
  state.counters["point_p50_us"] = percentile(each, 0.5);
  state.counters["point_p99_us"] = percentile(each, 0.99);
  state.counters["point_p9999_us"] = percentile(each, 0.9999);
  state.counters["point_max_us"] = percentile(each, 1.0);
  state.counters["scan_p50_ms"] = 1e-3 * percentile(whole, 0.5);
  state.counters["scan_p99_ms"] = 1e-3 * percentile(whole, 0.99);
  state.counters["scan_max_ms"] = 1e-3 * percentile(whole, 1.0);
}

void kd_tree_nearest(benchmark::State& state) {
  const auto length = static_cast<int>(state.range(0));
  const auto count = static_cast<std::size_t>(state.range(1));
  const map::KdTree tree = walked(length);
  std::array<map::Neighbor, kNeighbors> found;
  for (auto _ : state) {
    for (const Eigen::Vector3f& point : scans(length).back()) {
      benchmark::DoNotOptimize(tree.nearest(point, std::span(found).first(count), 2.236F));
    }
  }
  state.SetItemsProcessed(state.iterations() *
                          static_cast<std::int64_t>(scans(length).back().size()));
}

/// The alternative to an incremental tree: a new tree of all points of the map for each scan.
void kd_tree_rebuild(benchmark::State& state) {
  const Points points = walked(static_cast<int>(state.range(0))).points();
  for (auto _ : state) {
    map::KdTree tree;
    tree.build(points);
    benchmark::DoNotOptimize(tree.size());
  }
  state.counters["map_points"] = static_cast<double>(points.size());
}

map::VoxelHashMap voxel_map(const Points& points) {
  map::VoxelHashMap map({.voxel_size = 0.5, .max_points = 20, .min_spacing = 0.1});
  map.insert(points);
  return map;
}

void voxel_map_insertion(benchmark::State& state) {
  const std::vector<Points>& walk = scans(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    map::VoxelHashMap map = voxel_map({});
    for (const Points& scan : walk) map.insert(scan);
    state.counters["map_points"] = static_cast<double>(map.size());
  }
}

/// The voxel map returns only the nearest point.
void voxel_map_nearest(benchmark::State& state) {
  const auto length = static_cast<int>(state.range(0));
  const map::VoxelHashMap map = voxel_map(walked(length).points());
  for (auto _ : state) {
    for (const Eigen::Vector3f& point : scans(length).back()) {
      benchmark::DoNotOptimize(map.nearest(point, 2.236F));
    }
  }
  state.SetItemsProcessed(state.iterations() *
                          static_cast<std::int64_t>(scans(length).back().size()));
}

void plane_map_insertion(benchmark::State& state) {
  const std::vector<Points>& walk = scans(static_cast<int>(state.range(0)));
  std::int64_t points = 0;
  for (auto _ : state) {
    map::PlaneMap map({});
    for (const Points& scan : walk) {
      map.insert(scan);
      points += static_cast<std::int64_t>(scan.size());
    }
    state.counters["cells"] = static_cast<double>(map.size());
    state.counters["bytes"] = static_cast<double>(map.memory_bytes());
  }
  state.SetItemsProcessed(points);
}

void plane_map_lookup(benchmark::State& state) {
  const std::vector<Points>& walk = scans(static_cast<int>(state.range(0)));
  map::PlaneMap map({});
  for (const Points& scan : walk) map.insert(scan);
  for (auto _ : state) {
    for (const Eigen::Vector3f& point : walk.back())
      benchmark::DoNotOptimize(map.plane_at(point));
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(walk.back().size()));
}

#ifdef LIDARENA_HAVE_NANOFLANN
/// The interface that nanoflann requires of a point set.
struct Cloud {
  const Points& points;
  std::size_t kdtree_get_point_count() const { return points.size(); }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return points[i][static_cast<Eigen::Index>(axis)];
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};
using StaticTree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Cloud>, Cloud, 3>;

void nanoflann_rebuild(benchmark::State& state) {
  const Points points = walked(static_cast<int>(state.range(0))).points();
  const Cloud cloud{points};
  for (auto _ : state) {
    const StaticTree tree(3, cloud);
    benchmark::DoNotOptimize(&tree);
  }
  state.counters["map_points"] = static_cast<double>(points.size());
}

void nanoflann_nearest(benchmark::State& state) {
  const auto length = static_cast<int>(state.range(0));
  const auto count = static_cast<std::size_t>(state.range(1));
  const Points points = walked(length).points();
  const Cloud cloud{points};
  const StaticTree tree(3, cloud);
  std::array<std::uint32_t, kNeighbors> indices{};
  std::array<float, kNeighbors> distances{};
  for (auto _ : state) {
    for (const Eigen::Vector3f& point : scans(length).back()) {
      benchmark::DoNotOptimize(
          tree.knnSearch(point.data(), count, indices.data(), distances.data()));
    }
  }
  state.SetItemsProcessed(state.iterations() *
                          static_cast<std::int64_t>(scans(length).back().size()));
}
BENCHMARK(nanoflann_rebuild)->Arg(20)->Arg(100)->Unit(benchmark::kMillisecond);
BENCHMARK(nanoflann_nearest)
    ->ArgsProduct({{20, 100}, {1, kNeighbors}})
    ->Unit(benchmark::kMillisecond);
#endif

BENCHMARK(kd_tree_insertion)->Arg(20)->Arg(100)->Unit(benchmark::kMillisecond);
BENCHMARK(kd_tree_nearest)
    ->ArgsProduct({{20, 100}, {1, kNeighbors}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(kd_tree_rebuild)->Arg(20)->Arg(100)->Unit(benchmark::kMillisecond);
BENCHMARK(voxel_map_insertion)->Arg(20)->Arg(100)->Unit(benchmark::kMillisecond);
BENCHMARK(voxel_map_nearest)->Arg(20)->Arg(100)->Unit(benchmark::kMillisecond);
BENCHMARK(plane_map_insertion)->Arg(20)->Arg(100)->Unit(benchmark::kMillisecond);
BENCHMARK(plane_map_lookup)->Arg(20)->Arg(100)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lidarena
