// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/map_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "lidarena/evaluation/morton_order.hpp"

namespace lidarena {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kChunk = std::size_t{1} << 18U;  // points in flight; bounds the memory

/// Distances of the finite points of `map` (m), NaN for the others.
std::vector<double> distances_to(const World& world, std::span<const Eigen::Vector3f> map,
                                 const Pose& mesh_from_map, const Parallel& parallel) {
  const MortonOrder order = morton_order(map, parallel);
  std::vector<double> distances(map.size(), kNaN);
  std::vector<Eigen::Vector3d> moved(std::min(kChunk, order.entries.size()));
  std::vector<ClosestPoint> nearest(moved.size());
  for (std::size_t begin = 0; begin < order.entries.size(); begin += kChunk) {
    const auto entries = std::span(order.entries)
                             .subspan(begin)
                             .first(std::min(kChunk, order.entries.size() - begin));
    for (std::size_t k = 0; k < entries.size(); ++k) {
      moved[k] = mesh_from_map * map[entries[k].index].cast<double>();
    }
    world.closest_points(std::span(moved).first(entries.size()),
                         std::numeric_limits<double>::infinity(), nearest, parallel);
    for (std::size_t k = 0; k < entries.size(); ++k) {
      distances[entries[k].index] = nearest[k].distance;
    }
  }
  return distances;
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
  const std::vector<double> found = distances_to(world, map, mesh_from_map, parallel);
  if (distances != nullptr) {
    distances->resize(found.size());
    std::transform(found.begin(), found.end(), distances->begin(),
                   [](double d) { return static_cast<float>(d); });
  }
  return summarize_distances(found);
}

}  // namespace lidarena
