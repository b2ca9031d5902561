// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lidarena/evaluation/map/point_scores.hpp"
#include "lidarena/results/map_metrics.hpp"

namespace lidarena::evaluation {

/// On which side of a triangle there is free space, determined from the rays that hit it, because
/// the winding of a mesh is not reliable.
enum class FreeSide : std::int8_t {
  kBack = -1,    ///< opposite to the triangle's normal (b - a) x (c - a)
  kUnknown = 0,  ///< never hit, or hit from both sides
  kFront = 1,
};

using results::SignedDistance;
using results::SignedHistogram;

SignedDistance signed_distance(std::span<const PointScore> scores,
                               std::span<const FreeSide> free_side);

}  // namespace lidarena::evaluation
