// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/odometry/arena_slam/range_image.hpp"

namespace lidarena::odometry::arena_slam {

/// Points of a scan for matching with the map (m, LiDAR frame).
struct Features {
  std::vector<Eigen::Vector3f> edges;
  std::vector<Eigen::Vector3f> surfaces;
};

/// Points of a row that cannot be edges because they are not seen as edges from elsewhere: the far
/// side of a range jump, and surfaces at a grazing angle. One flag per pixel.
std::vector<bool> non_edge_points(std::span<const Pixel> row, const Config& config);

/// Squared sum (m^2) of the differences between the neighbors' ranges and a point's own; 0 near the
/// row's ends.
std::vector<float> roughness(std::span<const Pixel> row, const Config& config);

/// Edges are the roughest points of each sixth of a row, none adjacent to another; all other points
/// are surface points (Zhang, Singh, "LOAM", RSS 2014, section V-A, as in LIO-SAM).
Features extract_features(const RangeImage& image, const Config& config, const Parallel& parallel);

/// The features averaged in voxels of `edge_voxel_size_m` and `surface_voxel_size_m`.
Features thinned(const Features& features, const Config& config);

}  // namespace lidarena::odometry::arena_slam
