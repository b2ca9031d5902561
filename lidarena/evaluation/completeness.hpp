// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "lidarena/evaluation/observed_surface.hpp"
#include "lidarena/evaluation/point_grid.hpp"
#include "lidarena/evaluation/point_scores.hpp"

namespace lidarena {

/// Samples of the surface that rays hit, equally dense everywhere: as many to a square meter of a
/// large triangle as of small ones.
struct SurfaceSamples {
  /// One in 10 cm^2. Distances from them to the map are exact, so their density makes no bias; it
  /// sets the error of a share p, sqrt(p (1 - p) / samples): 0.05 % of 100 m^2 at most.
  static constexpr double kPerSquareMeter = 1000.0;
  static constexpr double kSeen_m = 0.02;  ///< a sample was seen when a true hit is this near
  std::vector<Eigen::Vector3f> offsets;    ///< m, from the mesh's center (center_of())
  double area_m2() const { return static_cast<double>(offsets.size()) / kPerSquareMeter; }
};

/// Stratified by area along the list of triangles and within each; the same for the same mesh, on
/// any number of threads.
SurfaceSamples seen_samples(const World& world, const ObservedSurface& seen,
                            const Parallel& parallel);

/// How much of the seen surface the map has, and both ways in one number.
struct Completeness {
  static constexpr std::array<double, 4> kWithin_m{0.02, 0.05, 0.10, 0.20};
  struct Row {
    double precision_percent = 0.0;  ///< points of the map within this of the mesh
    double recall_percent = 0.0;     ///< seen samples with a point of the map within this
    double f_score_percent = 0.0;    ///< 2 P R / (P + R)
  };
  std::size_t samples = 0;
  double seen_m2 = 0.0;
  std::array<Row, kWithin_m.size()> rows{};
};

/// The grid that completeness() asks: of the map in its own frame.
PointGrid completeness_grid(std::span<const Eigen::Vector3f> map, const Parallel& parallel);

Completeness completeness(const SurfaceSamples& samples, const PointGrid& grid,
                          std::span<const PointScore> scores, const Pose& mesh_from_map,
                          const World& world, const Parallel& parallel);

}  // namespace lidarena
