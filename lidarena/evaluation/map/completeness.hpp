// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "lidarena/evaluation/map/observed_surface.hpp"
#include "lidarena/evaluation/map/point_grid.hpp"
#include "lidarena/evaluation/map/point_scores.hpp"

namespace lidarena::evaluation {

/// Samples of the surface that rays hit, with the same density per area on large and small
/// triangles.
struct SurfaceSamples {
  /// One sample per 10 cm^2. Distances from samples to the map are exact, so the density causes no
  /// bias. It determines the standard error of a share p, sqrt(p (1 - p) / samples): at most 0.16 %
  /// for 100 m^2.
  static constexpr double kPerSquareMeter = 1000.0;
  static constexpr double kSeen_m = 0.02;  ///< a sample was seen when a true hit is this near
  std::vector<Eigen::Vector3f> offsets;    ///< m, from the mesh's center (center_of())
  double area_m2() const { return static_cast<double>(offsets.size()) / kPerSquareMeter; }
};

/// Samples stratified by area along the list of triangles and within each triangle; the same for
/// the same mesh and hits on any number of threads.
SurfaceSamples seen_samples(const world::World& world, const ObservedSurface& seen,
                            const Parallel& parallel);

/// Precision, recall and F-score of the map with respect to the seen surface.
struct Completeness {
  static constexpr std::array<double, 4> kWithin_m{0.02, 0.05, 0.10, 0.20};
  struct Row {
    double precision_percent = 0.0;  ///< map points within this distance of the mesh
    double recall_percent = 0.0;     ///< seen samples with a map point within this
    double f_score_percent = 0.0;    ///< 2 P R / (P + R)
  };
  std::size_t samples = 0;
  double seen_m2 = 0.0;
  std::array<Row, kWithin_m.size()> rows{};
};

/// Nearest-neighbor grid of the map, in the map frame, as completeness() needs it.
PointGrid completeness_grid(std::span<const Eigen::Vector3f> map, const Parallel& parallel);

Completeness completeness(const SurfaceSamples& samples, const PointGrid& grid,
                          std::span<const PointScore> scores, const Pose& mesh_from_map,
                          const world::World& world, const Parallel& parallel);

}  // namespace lidarena::evaluation
