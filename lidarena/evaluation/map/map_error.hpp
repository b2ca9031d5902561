// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/pose.hpp"
#include "lidarena/evaluation/map/point_scores.hpp"
#include "lidarena/evaluation/summary.hpp"
#include "lidarena/world/world.hpp"

namespace lidarena::evaluation {

/// Distance of each map point to the mesh, and its statistics (paper section 3; definition
/// `map_error` of docs/metrics.md).
struct MapError {
  static constexpr double kOutlier_m = 0.20;  ///< the paper's threshold
  static constexpr double kBin_m = 0.01;      ///< width of a histogram bin
  static constexpr std::size_t kBins = 20;    ///< 0..20 cm; farther points count as outliers
  std::size_t points = 0;                     ///< number of scored points
  std::size_t invalid = 0;                    ///< NaN or infinite points, left out
  Summary distance_m;                         ///< over all points
  std::size_t inliers = 0;                    ///< points within 20 cm
  double rmse_inliers_m = 0.0;                ///< over the inliers
  double outliers_percent = 0.0;              ///< share of points beyond 20 cm
  std::vector<std::uint64_t> histogram = std::vector<std::uint64_t>(kBins, 0);  ///< of inliers
};

/// Statistics of distances to a surface (m); values that are not finite count as invalid.
MapError summarize_distances(std::span<const double> distances);

/// Scores `map` after moving it by `mesh_from_map`: exact distance to the nearest triangle.
/// `distances`, if given, receives one value per point (m; NaN for invalid points). Bit-identical
/// for any number of threads.
MapError map_error(std::span<const Eigen::Vector3f> map, const Pose& mesh_from_map,
                   const world::World& world, const Parallel& parallel,
                   std::vector<float>* distances = nullptr);

/// The same from given scores of a map of `points` points (invalid ones included).
MapError map_error(const MortonOrder& order, std::span<const PointScore> scores, std::size_t points,
                   std::vector<float>* distances = nullptr);

}  // namespace lidarena::evaluation
