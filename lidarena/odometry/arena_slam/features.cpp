// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_slam/features.hpp"

namespace lidarena::odometry::arena_slam {
FeatureRule feature_rule(const LidarInfo& lidar, const Config& config) {
  FeatureRule rule;
  rule.layout.by_azimuth = lidar.kind == "spinning";
  if (lidar.columns > 0) rule.layout.columns = lidar.columns;
  rule.layout.min_range_m = config.min_range_m;
  rule.layout.max_range_m = config.max_range_m;
  rule.edges = rule.layout.by_azimuth ? estimation::kSpinningEdges : estimation::kLivoxEdges;
  return rule;
}

map::FeatureVoxels feature_voxels(const Config& config) {
  return {config.edge_voxel_size_m, config.surface_voxel_size_m, map::GridAxes::kRotated};
}

}  // namespace lidarena::odometry::arena_slam
