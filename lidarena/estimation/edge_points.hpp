// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "lidarena/estimation/range_image.hpp"

namespace lidarena::estimation {

/// What makes a point an edge.
struct EdgeRule {
  int neighbors = 5;          ///< on each side, with which a point's range is compared
  double threshold_m2 = 1.0;  ///< minimum roughness
  int per_sector = 20;        ///< upper limit on the edges of a sector, which is a sixth of a row
  int occluded_points = 6;    ///< excluded on the far side of a range jump
  /// Points whose range differs from that of both neighbors by more than this share are excluded.
  double grazing_share = 0.02;
};

/// The rule of LIO-SAM for spinning LiDARs.
inline constexpr EdgeRule kSpinningEdges{5, 1.0, 20, 6, 0.02};
/// The rule of its port to the Livox Mid-360, whose points lie farther apart.
inline constexpr EdgeRule kLivoxEdges{2, 1.0, 40, 3, 0.1};

/// Points of a row that cannot be edges because they are not seen as edges from elsewhere: the far
/// side of a range jump, and surfaces at a grazing angle. One flag per pixel.
std::vector<bool> non_edge_points(std::span<const Pixel> row, const EdgeRule& rule);

/// Squared sum (m^2) of the differences between the neighbors' ranges and a point's own; 0 near the
/// row's ends.
std::vector<float> roughness(std::span<const Pixel> row, int neighbors);

/// Edges are the roughest points of each sixth of a row, none adjacent to another (Zhang, Singh,
/// "LOAM", RSS 2014, section V-A, as in LIO-SAM). One flag per pixel.
std::vector<bool> find_edges(std::span<const Pixel> row, const EdgeRule& rule);

}  // namespace lidarena::estimation
