// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>

#include "lidarena/evaluation/map/point_scores.hpp"
#include "lidarena/results/map_metrics.hpp"

namespace lidarena::evaluation {

using results::VoxelError;

/// The grid is aligned with the map frame, so the voxels are the same in every alignment.
VoxelError voxel_error(const MortonOrder& order, std::span<const PointScore> scores);

}  // namespace lidarena::evaluation
