// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/pose.hpp"
#include "lidarena/evaluation/map/point_scores.hpp"
#include "lidarena/results/map_metrics.hpp"
#include "lidarena/world/world.hpp"

namespace lidarena::evaluation {

using results::MapError;

/// Statistics of distances to a surface (m); values that are not finite count as invalid.
MapError summarize_distances(std::span<const double> distances);

/// Scores `map` after moving it by `mesh_from_map`: exact distance to the nearest triangle.
/// `distances`, if given, receives one value per point (m; NaN for invalid points). Bit-identical
/// for any number of threads.
MapError map_error(std::span<const Eigen::Vector3f> map, const Pose& mesh_from_map,
                   const world::World& world, const Parallel& parallel,
                   std::vector<float>* distances = nullptr);

/// The same from given scores of a map of `points` points (invalid ones included).
MapError map_error(const MortonOrder& order, std::span<const PointScore> scores, std::size_t points,
                   std::vector<float>* distances = nullptr);

}  // namespace lidarena::evaluation
