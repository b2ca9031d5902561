// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>

#include "lidarena/evaluation/map/point_scores.hpp"
#include "lidarena/evaluation/summary.hpp"

namespace lidarena::evaluation {

/// Map error in which each occupied voxel of the map counts once, however many points it holds, so
/// that near walls with their many points do not outweigh far ones.
struct VoxelError {
  static constexpr double kVoxel_m = 0.05;
  std::size_t voxels = 0;
  /// Root mean square of the point distances in each voxel (m). The RMSE of these values is the
  /// RMSE of the points weighted by 1 / (points in the voxel).
  Summary rms_m;
  double outliers_percent = 0.0;  ///< mean over voxels of the share of points beyond 20 cm
};

/// The grid is aligned with the map frame, so the voxels are the same in every gauge.
VoxelError voxel_error(const MortonOrder& order, std::span<const PointScore> scores);

}  // namespace lidarena::evaluation
