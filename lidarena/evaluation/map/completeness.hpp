// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "lidarena/evaluation/map/observed_surface.hpp"
#include "lidarena/evaluation/map/point_grid.hpp"
#include "lidarena/evaluation/map/point_scores.hpp"
#include "lidarena/results/map_metrics.hpp"

namespace lidarena::evaluation {

/// Samples of the surface that rays hit, with the same density per area on large and small
/// triangles.
struct SurfaceSamples {
  static constexpr double kPerSquareMeter = results::Completeness::kSamplesPerSquareMeter;
  static constexpr double kSeen_m = 0.02;  ///< a sample was seen when a true hit is this near
  std::vector<Eigen::Vector3f> offsets;    ///< m, from the mesh's center (center_of())
  double area_m2() const { return static_cast<double>(offsets.size()) / kPerSquareMeter; }
};

/// Samples stratified by area along the list of triangles and within each triangle; the same for
/// the same mesh and hits on any number of threads.
SurfaceSamples seen_samples(const world::World& world, const ObservedSurface& seen,
                            const Parallel& parallel);

using results::Completeness;

/// Nearest-neighbor grid of the map, in the map frame, as completeness() needs it.
PointGrid completeness_grid(std::span<const Eigen::Vector3f> map, const Parallel& parallel);

Completeness completeness(const SurfaceSamples& samples, const PointGrid& grid,
                          std::span<const PointScore> scores, const Pose& mesh_from_map,
                          const world::World& world, const Parallel& parallel);

}  // namespace lidarena::evaluation
