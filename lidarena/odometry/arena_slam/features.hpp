// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/base/rig.hpp"
#include "lidarena/odometry/arena_slam/config.hpp"
#include "lidarena/odometry/feature_extraction.hpp"

namespace lidarena::odometry::arena_slam {

/// Spinning LiDARs have columns by azimuth; all others, whose pattern does not repeat, by firing
/// order.
FeatureRule feature_rule(const LidarInfo& lidar, const Config& config);

/// Voxels of rotated grids.
map::FeatureVoxels feature_voxels(const Config& config);

}  // namespace lidarena::odometry::arena_slam
