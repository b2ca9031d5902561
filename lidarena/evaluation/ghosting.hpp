// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>

#include "lidarena/base/parallel.hpp"
#include "lidarena/evaluation/point_scores.hpp"
#include "lidarena/evaluation/summary.hpp"

namespace lidarena {

/// Double walls, which a limit of 20 cm misses: how thick the map is over each patch of the surface
/// and whether its points there form two sheets.
struct Ghosting {
  static constexpr double kPatch_m = 0.20;  ///< cubes that cut the surface into patches
  static constexpr double kReach_m = 0.50;  ///< points farther from the mesh belong to no patch
  static constexpr std::size_t kLeastPoints = 50;  ///< of a patch that is judged
  /// Two sheets: the patch split in two where the variance between the parts is largest (Otsu
  /// 1979); the smaller part holds at least 5 % (and 5 points); Ashman's D (Ashman, Bird, Zepf
  /// 1994) of the parts is above 4 (one normal distribution split so has 2.65, an even one 3.46);
  /// and the middle third between their means is a valley, with less than a quarter of the smaller
  /// part's points.
  static constexpr double kLeastShare = 0.05;
  static constexpr double kLeastInPart = 5.0;
  static constexpr double kLeastSeparation = 4.0;
  static constexpr double kValley = 0.25;
  static constexpr double kLeastApart_m = 0.02;  ///< of the means; less is any sensor's noise
  std::size_t patches = 0;                       ///< judged
  Summary thickness_m;               ///< P95 - P5 of the heights over the surface, by patch
  std::size_t double_patches = 0;    ///< of two sheets
  double double_percent = 0.0;       ///< share of the patches
  double median_separation_m = 0.0;  ///< between the sheets' means, over double patches
};

/// The two parts of a patch.
struct Sheets {
  double smaller_share = 0.0;  ///< 0..0.5
  double separation_m = 0.0;   ///< between the means
  double middle_m = 0.0;       ///< half way between them
  double ashman_d = 0.0;
  bool are_two = false;
};
/// Of at least two heights, rising.
Sheets split_sheets(std::span<const float> sorted_heights);

/// Heights are counted along the surface's normal, turned to the positive side of its largest
/// component: how triangles are wound does not matter.
Ghosting ghosting(std::span<const PointScore> scores, const World& world, const Parallel& parallel);

}  // namespace lidarena
