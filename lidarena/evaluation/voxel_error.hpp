// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>

#include "lidarena/evaluation/point_scores.hpp"
#include "lidarena/evaluation/summary.hpp"

namespace lidarena {

/// Map error where each occupied cube of the map counts once, however many points it holds: near
/// walls, where points crowd, do not outweigh far ones.
struct VoxelError {
  static constexpr double kVoxel_m = 0.05;
  std::size_t voxels = 0;
  /// Of each cube the root mean square of its points' distances (m); the root mean square of these
  /// is the RMSE with each point weighted by 1 / (points of its cube).
  Summary rms_m;
  double outliers_percent = 0.0;  ///< mean over cubes of the share of points beyond 20 cm
};

/// The grid is the map's own, so the cubes are the same in every gauge.
VoxelError voxel_error(const MortonOrder& order, std::span<const PointScore> scores);

}  // namespace lidarena
