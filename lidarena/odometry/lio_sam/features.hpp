// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/odometry/lio_sam/range_image.hpp"

namespace lidarena::lio_sam {

/// What of a scan is matched with the map (m, LiDAR frame).
struct Features {
  std::vector<Eigen::Vector3f> edges;
  std::vector<Eigen::Vector3f> surfaces;
};

/// The points of a row from which the range jumps away or which graze their surface: no edge is
/// seen from elsewhere there. One flag a pixel.
std::vector<bool> barred_points(std::span<const Pixel> row, const Config& config);

/// Square (m^2) of the sum of the neighbors' ranges beyond a point's own; 0 near the row's ends.
std::vector<float> roughness(std::span<const Pixel> row, const Config& config);

/// Edges are the roughest points of each sixth of a row, not next to each other; all others are
/// surface (Zhang, Singh, "LOAM", RSS 2014, section V-A, as LIO-SAM has it).
Features extract_features(const RangeImage& image, const Config& config, const Parallel& parallel);

/// Averaged in cells of `edge_leaf_m` and `surface_leaf_m`.
Features thinned(const Features& features, const Config& config);

}  // namespace lidarena::lio_sam
