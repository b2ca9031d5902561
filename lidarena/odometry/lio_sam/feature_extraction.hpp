// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/base/parallel.hpp"
#include "lidarena/estimation/edge_points.hpp"
#include "lidarena/map/feature_map.hpp"

namespace lidarena::odometry::lio_sam {

/// How features are found in a scan.
struct FeatureRule {
  estimation::ImageLayout layout;
  estimation::EdgeRule edges;
  double row_surface_voxel_size_m = 0.4;  ///< in which the surface points of each row are averaged
};

/// The edges of each row (LOAM, section V-A); all its other points are surface points. In the
/// frame of the image's points.
map::Features extract_features(const estimation::RangeImage& image, const FeatureRule& rule,
                               const Parallel& parallel);

}  // namespace lidarena::odometry::lio_sam
