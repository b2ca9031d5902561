// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/map_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "lidarena/map/voxel_key.hpp"

namespace lidarena {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kChunk = std::size_t{1} << 18U;  // points in flight; bounds the memory
constexpr float kCellsPerMetre = 2.0F;

/// Indices of the finite points, those of one half-metre cell together: neighbours in space walk
/// the same branches of the mesh's tree, and what one loads the next finds in the cache.
std::vector<std::size_t> in_order_of_cells(std::span<const Eigen::Vector3f> points) {
  std::vector<std::pair<VoxelKey, std::size_t>> keyed;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite()) continue;
    keyed.emplace_back(voxel_key(voxel_of(points[i], kCellsPerMetre)), i);
  }
  std::sort(keyed.begin(), keyed.end());
  std::vector<std::size_t> order(keyed.size());
  std::transform(keyed.begin(), keyed.end(), order.begin(), [](const auto& k) { return k.second; });
  return order;
}

/// Distances of the finite points of `map` (m), NaN for the others.
void distances_to(const World& world, std::span<const Eigen::Vector3f> map,
                  const Pose& mesh_from_map, const Parallel& parallel, std::span<double> out) {
  const std::vector<std::size_t> order = in_order_of_cells(map);
  std::vector<Eigen::Vector3d> moved;
  moved.reserve(order.size());
  for (const std::size_t i : order) moved.push_back(mesh_from_map * map[i].cast<double>());
  std::vector<ClosestPoint> nearest(moved.size());
  world.closest_points(moved, std::numeric_limits<double>::infinity(), nearest, parallel);
  std::fill(out.begin(), out.end(), kNaN);
  for (std::size_t k = 0; k < order.size(); ++k) out[order[k]] = nearest[k].distance;
}

}  // namespace

MapError summarize_distances(std::span<const double> distances) {
  MapError error;
  std::vector<double> finite;
  finite.reserve(distances.size());
  double inlier_squares = 0.0;
  for (const double d : distances) {
    if (!std::isfinite(d)) {
      ++error.invalid;
      continue;
    }
    finite.push_back(d);
    if (d > MapError::kOutlier_m) continue;
    ++error.inliers;
    inlier_squares += d * d;
    const auto bin = static_cast<std::size_t>(d / MapError::kBin_m);
    ++error.histogram[std::min(bin, MapError::kBins - 1)];
  }
  error.points = finite.size();
  error.distance_m = summarize(finite);
  if (error.points == 0) return error;
  const auto outliers = static_cast<double>(error.points - error.inliers);
  error.outliers_percent = 100.0 * outliers / static_cast<double>(error.points);
  if (error.inliers > 0) {
    error.rmse_inliers_m = std::sqrt(inlier_squares / static_cast<double>(error.inliers));
  }
  return error;
}

MapError map_error(std::span<const Eigen::Vector3f> map, const Pose& mesh_from_map,
                   const World& world, const Parallel& parallel, std::vector<float>* distances) {
  std::vector<double> found(map.size());
  for (std::size_t begin = 0; begin < map.size(); begin += kChunk) {
    const std::size_t count = std::min(kChunk, map.size() - begin);
    distances_to(world, map.subspan(begin, count), mesh_from_map, parallel,
                 std::span(found).subspan(begin, count));
  }
  if (distances != nullptr) {
    distances->resize(found.size());
    std::transform(found.begin(), found.end(), distances->begin(),
                   [](double d) { return static_cast<float>(d); });
  }
  return summarize_distances(found);
}

}  // namespace lidarena
