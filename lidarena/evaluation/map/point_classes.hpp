// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "lidarena/base/point_truth.hpp"
#include "lidarena/evaluation/map/point_scores.hpp"
#include "lidarena/results/map_metrics.hpp"

namespace lidarena::evaluation {

using results::PointClasses;

/// Shares and errors of the classes of a map's scored points. `classes` has one per point of that
/// map, in the order in which `order` counts them; `scores` are in `order`. Empty without classes.
PointClasses point_classes(std::span<const PointClass> classes, const MortonOrder& order,
                           std::span<const PointScore> scores);

}  // namespace lidarena::evaluation
