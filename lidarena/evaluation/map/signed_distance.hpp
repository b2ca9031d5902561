// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lidarena/evaluation/map/point_scores.hpp"

namespace lidarena::evaluation {

/// On which side of a triangle there is free space, determined from the rays that hit it, because
/// the winding of a mesh is not reliable.
enum class FreeSide : std::int8_t {
  kBack = -1,    ///< opposite to the triangle's normal (b - a) x (c - a)
  kUnknown = 0,  ///< never hit, or hit from both sides
  kFront = 1,
};

/// Signed distance: positive in free space, in front of the surface as the sensor saw it; negative
/// behind it. A range bias shifts the mean, a double wall makes a second peak.
struct SignedDistance {
  static constexpr double kRange_m = 0.20;  ///< the histogram covers -20..20 cm
  static constexpr double kBin_m = 0.01;
  static constexpr std::size_t kBins = 40;
  /// A point whose direction from its nearest triangle is more than 60 degrees off the normal is
  /// beside an edge; that triangle does not determine on which side it lies.
  static constexpr double kMinCosine = 0.5;
  std::size_t points = 0;   ///< number of points with a sign
  std::size_t without = 0;  ///< beside an edge, or nearest to a triangle whose free side is unknown
  double mean_m = 0.0, median_m = 0.0, p5_m = 0.0, p95_m = 0.0;  ///< 0 when there are no points
  double behind_percent = 0.0;                                   ///< share below zero
  std::vector<std::uint64_t> histogram = std::vector<std::uint64_t>(kBins, 0);
  std::size_t below = 0, above = 0;  ///< beyond -20 and +20 cm
};

SignedDistance signed_distance(std::span<const PointScore> scores,
                               std::span<const FreeSide> free_side);

}  // namespace lidarena::evaluation
