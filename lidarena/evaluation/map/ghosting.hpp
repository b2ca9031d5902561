// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>

#include "lidarena/base/parallel.hpp"
#include "lidarena/evaluation/map/point_scores.hpp"
#include "lidarena/results/map_metrics.hpp"

namespace lidarena::evaluation {

using results::Ghosting;

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
