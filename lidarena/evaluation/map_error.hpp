// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/pose.hpp"
#include "lidarena/evaluation/trajectory_error.hpp"
#include "lidarena/world/world.hpp"

namespace lidarena {

/// Distance of each map point to the mesh, and its statistics (paper section 3).
struct MapError {
  static constexpr double kOutlier_m = 0.20;    ///< the paper's threshold
  static constexpr double kBin_m = 0.01;        ///< width of a histogram bin
  static constexpr std::size_t kBins = 20;      ///< 0..20 cm; farther points count as outliers
  std::size_t points = 0;
  std::size_t invalid = 0;          ///< NaN or infinite points, left out
  Summary distance_m;               ///< over all points
  double rmse_inliers_m = 0.0;      ///< over points within 20 cm
  double outliers_percent = 0.0;
  std::vector<std::uint64_t> histogram;  ///< kBins counts
};

/// Scores `map` after moving it by `mesh_from_map`. `distances`, if given, receives one value a
/// point (m; NaN for invalid points).
MapError map_error(std::span<const Eigen::Vector3f> map, const Pose& mesh_from_map,
                   const World& world, const Parallel& parallel,
                   std::vector<float>* distances = nullptr);

}  // namespace lidarena
