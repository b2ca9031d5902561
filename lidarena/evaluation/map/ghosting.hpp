// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>

#include "lidarena/base/parallel.hpp"
#include "lidarena/evaluation/map/point_scores.hpp"
#include "lidarena/evaluation/summary.hpp"

namespace lidarena::evaluation {

/// Double walls (ghosting), which the 20 cm outlier limit does not detect: how thick the map is
/// over each patch of the surface, and whether its points there form two sheets.
struct Ghosting {
  static constexpr double kPatch_m = 0.20;  ///< edge of the cubes that divide the surface
  static constexpr double kReach_m = 0.50;  ///< points farther from the mesh belong to no patch
  static constexpr std::size_t kMinPoints = 50;  ///< minimum for a patch to be judged
  /// Criteria for two sheets. The patch is split where the variance between the parts is largest
  /// (Otsu 1979). The smaller part holds at least 5 % of the points (and 5 points). Ashman's D
  /// (Ashman, Bird, Zepf 1994) of the parts is above 4 (a normal distribution split this way has
  /// 2.65, a uniform one 3.46). The middle third between their means is a valley: it has less than
  /// a quarter of the smaller part's points.
  static constexpr double kMinShare = 0.05;
  static constexpr double kMinInPart = 5.0;
  static constexpr double kMinAshmanD = 4.0;
  static constexpr double kValley = 0.25;
  static constexpr double kMinMeanDistance_m = 0.02;  ///< of the means; less is within sensor noise
  std::size_t patches = 0;                            ///< number of judged patches
  Summary thickness_m;               ///< P95 - P5 of the heights above the surface, by patch
  std::size_t double_patches = 0;    ///< patches with two sheets
  double double_percent = 0.0;       ///< share of double patches
  double median_separation_m = 0.0;  ///< between the sheets' means, over double patches
};

/// The two parts into which a patch is split.
struct Sheets {
  double smaller_share = 0.0;  ///< share of points in the smaller part, 0..0.5
  double separation_m = 0.0;   ///< distance between the means
  double middle_m = 0.0;       ///< midpoint of the means
  double ashman_d = 0.0;
  bool are_two = false;
};
/// Splits at least two heights (m), sorted in ascending order.
Sheets split_sheets(std::span<const float> sorted_heights);

/// Heights are measured along the surface's normal, flipped so that its largest component is
/// positive; the result does not depend on the winding of the triangles.
Ghosting ghosting(std::span<const PointScore> scores, const world::World& world,
                  const Parallel& parallel);

}  // namespace lidarena::evaluation
