// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lo/sampling.hpp"

#include <tsl/robin_map.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <tuple>

#include "lidarena/map/voxel_key.hpp"

namespace lidarena::odometry::arena_lo {

namespace {

/// Cells of the adaptive grid: `edge` m for points nearer than `range` m; values of the published
/// program.
struct Ring {
  float range;
  double edge;
};
constexpr float kNearest = 0.5F;
constexpr std::array kRings{Ring{2.0F, 0.1}, Ring{4.0F, 0.2}, Ring{8.0F, 0.4}, Ring{16.0F, 0.8},
                            Ring{200.0F, 1.6}};

/// Pseudo-random rank, unique for each index: two rounds of a bijective mix.
std::uint32_t rank_of(std::uint32_t index) {
  index = (index ^ (index >> 16U)) * 0x7FEB352DU;  // constants of Wellons' hash prospector
  index = (index ^ (index >> 15U)) * 0x846CA68BU;
  return index ^ (index >> 16U);
}

std::vector<TimedPoint> adaptive(std::span<const TimedPoint> frame, map::VoxelRounding rounding) {
  std::array<std::vector<TimedPoint>, kRings.size()> by_ring;
  for (const TimedPoint& point : frame) {
    const float range = point.position.norm();
    if (range < kNearest) continue;
    const auto ring = std::find_if(kRings.begin(), kRings.end(),
                                   [&](const Ring& candidate) { return range < candidate.range; });
    if (ring != kRings.end())
      by_ring[static_cast<std::size_t>(ring - kRings.begin())].push_back(point);
  }
  std::vector<TimedPoint> keypoints;
  for (std::size_t i = 0; i < kRings.size(); ++i) {
    const auto part = thin(by_ring[i], kRings[i].edge, rounding);
    keypoints.insert(keypoints.end(), part.begin(), part.end());
  }
  return keypoints;
}

/// Reduces `points` to `limit` of them, drawn uniformly.
void draw(std::vector<TimedPoint>& points, std::size_t limit) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> order;
  for (std::uint32_t i = 0; i < points.size(); ++i) order.emplace_back(rank_of(i), i);
  std::sort(order.begin(), order.end());
  order.resize(limit);
  std::vector<TimedPoint> drawn;
  for (const auto& [rank, index] : order) drawn.push_back(points[index]);
  points = std::move(drawn);
}

}  // namespace

std::vector<TimedPoint> timed_points(const Scan& scan, const estimation::ScanTimes& times,
                                     bool rigid, const SamplingConfig& config) {
  const auto begin = static_cast<double>((times.first - scan.stamp).count());
  const auto length = static_cast<double>((times.last - times.first).count());
  const double per_ns = rigid ? 0.0 : 1.0 / length;
  const double squared_min = config.min_range_m * config.min_range_m;
  const double squared_max = config.max_range_m * config.max_range_m;
  std::vector<TimedPoint> points;
  points.reserve(scan.points.size());
  for (const Point& point : scan.points) {
    const double squared_range = point.position.cast<double>().squaredNorm();
    if (!(squared_min <= squared_range && squared_range < squared_max)) continue;  // also drops NaN
    const double alpha = rigid ? 1.0 : (point.dt_ns - begin) * per_ns;
    points.push_back({point.position, static_cast<float>(alpha)});
  }
  return points;
}

std::vector<TimedPoint> thin(std::span<const TimedPoint> points, double voxel,
                             map::VoxelRounding rounding) {
  struct Cell {
    std::uint64_t order;   // low bits of the hash
    std::uint32_t first;   // index of the first point met in the cell
    std::uint32_t chosen;  // index of its point of the lowest rank
  };
  const auto inverse = static_cast<float>(1.0 / voxel);
  const std::uint64_t order_bits = std::bit_ceil(points.size() + 1) - 1;
  std::vector<Cell> cells;
  tsl::robin_map<map::VoxelKey, std::size_t, map::VoxelKeyHash> index_of_cell;
  index_of_cell.reserve(points.size() / 2);
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const map::VoxelKey key = map::voxel_key(map::voxel_of(points[i].position, inverse, rounding));
    const auto [found, is_new] = index_of_cell.try_emplace(key, cells.size());
    if (is_new) {
      cells.push_back({map::VoxelKeyHash{}(key)&order_bits, i, i});
    } else if (Cell& cell = cells[found->second]; rank_of(i) < rank_of(cell.chosen)) {
      cell.chosen = i;
    }
  }
  std::sort(cells.begin(), cells.end(), [](const Cell& a, const Cell& b) {
    return std::tie(a.order, a.first) < std::tie(b.order, b.first);
  });
  std::vector<TimedPoint> kept;
  kept.reserve(cells.size());
  for (const Cell& cell : cells) kept.push_back(points[cell.chosen]);
  return kept;
}

std::vector<TimedPoint> sample_keypoints(std::span<const TimedPoint> frame,
                                         KeypointSampling sampling, double voxel, int limit,
                                         map::VoxelRounding rounding) {
  std::vector<TimedPoint> keypoints;
  switch (sampling) {
    case KeypointSampling::kAll:
      keypoints.assign(frame.begin(), frame.end());
      break;
    case KeypointSampling::kGrid:
      keypoints = thin(frame, voxel, rounding);
      break;
    case KeypointSampling::kAdaptive:
      keypoints = adaptive(frame, rounding);
      break;
  }
  const auto most = static_cast<std::size_t>(limit);
  if (most > 0 && keypoints.size() > most) draw(keypoints, most);
  return keypoints;
}

}  // namespace lidarena::odometry::arena_lo
