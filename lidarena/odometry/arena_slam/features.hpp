// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/rig.hpp"
#include "lidarena/estimation/edge_points.hpp"
#include "lidarena/odometry/arena_slam/config.hpp"

namespace lidarena::odometry::arena_slam {

/// Points of a scan for matching with the map (m, LiDAR frame).
struct Features {
  std::vector<Eigen::Vector3f> edges;
  std::vector<Eigen::Vector3f> surfaces;
};

/// How features are found in the scans of a kind of LiDAR.
struct FeatureRule {
  estimation::ImageLayout layout;
  estimation::EdgeRule edges;
};
/// Spinning LiDARs have columns by azimuth; all others, whose pattern does not repeat, by firing
/// order.
FeatureRule feature_rule(const LidarInfo& lidar, const Config& config);

/// The edges of each row; all other points are surface points.
Features extract_features(const estimation::RangeImage& image, const estimation::EdgeRule& rule,
                          const Parallel& parallel);

/// The features averaged in voxels of `edge_voxel_size_m` and `surface_voxel_size_m`, in rotated
/// grids.
Features thinned(const Features& features, const Config& config);

}  // namespace lidarena::odometry::arena_slam
