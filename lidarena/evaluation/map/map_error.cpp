// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/map/map_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "lidarena/evaluation/map/morton_order.hpp"

namespace lidarena::evaluation {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

}  // namespace

MapError summarize_distances(std::span<const double> distances) {
  MapError error;
  std::vector<double> finite;
  finite.reserve(distances.size());
  double inlier_squares = 0.0;
  std::vector<std::uint64_t>& counts = error.histogram.counts;
  for (const double d : distances) {
    if (!std::isfinite(d)) {
      ++error.invalid;
      continue;
    }
    finite.push_back(d);
    if (d > MapError::kOutlier_m) continue;
    ++error.inliers;
    inlier_squares += d * d;
    const auto bin = static_cast<std::size_t>(d / results::DistanceHistogram::kBin_m);
    ++counts[std::min(bin, counts.size() - 1)];
  }
  error.points = finite.size();
  error.distance_m = results::summarize(finite);
  if (error.points == 0) return error;
  const auto outliers = static_cast<double>(error.points - error.inliers);
  error.outliers_percent = 100.0 * outliers / static_cast<double>(error.points);
  if (error.inliers > 0) {
    error.rmse_inliers_m = std::sqrt(inlier_squares / static_cast<double>(error.inliers));
  }
  error.histogram.beyond = error.points - error.inliers;
  std::uint64_t within = 0;
  for (const std::uint64_t count : counts) {
    within += count;
    error.cdf_percent.push_back(100.0 * static_cast<double>(within) /
                                static_cast<double>(error.points));
  }
  return error;
}

MapError map_error(std::span<const Eigen::Vector3f> map, const Pose& mesh_from_map,
                   const world::World& world, const Parallel& parallel,
                   std::vector<float>* distances) {
  const MortonOrder order = morton_order(map, parallel);
  const std::vector<PointScore> scores = score_points(map, order, mesh_from_map, world, parallel);
  return map_error(order, scores, map.size(), distances);
}

MapError map_error(const MortonOrder& order, std::span<const PointScore> scores, std::size_t points,
                   std::vector<float>* distances) {
  std::vector<double> found(points, kNaN);  // in the order of the map, in which they are summed
  for (std::size_t k = 0; k < scores.size(); ++k) {
    found[order.entries[k].index] = scores[k].distance;
  }
  if (distances != nullptr) {
    distances->resize(found.size());
    std::transform(found.begin(), found.end(), distances->begin(),
                   [](double d) { return static_cast<float>(d); });
  }
  return summarize_distances(found);
}

}  // namespace lidarena::evaluation
