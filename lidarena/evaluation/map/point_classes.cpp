// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/map/point_classes.hpp"

#include <array>
#include <cmath>

namespace lidarena::evaluation {
namespace {

using results::ClassOfPoints;

struct Sums {
  std::size_t points = 0, outliers = 0;
  double squares_m2 = 0.0;

  void add(double distance) {
    ++points;
    squares_m2 += distance * distance;
    if (distance > results::MapError::kOutlier_m) ++outliers;
  }
};

ClassOfPoints figures_of(const Sums& sums, std::size_t all) {
  ClassOfPoints figures;
  if (sums.points == 0) return figures;
  const auto points = static_cast<double>(sums.points);
  figures.points = sums.points;
  figures.share_percent = 100.0 * points / static_cast<double>(all);
  figures.rmse_m = std::sqrt(sums.squares_m2 / points);
  figures.outliers_percent = 100.0 * static_cast<double>(sums.outliers) / points;
  return figures;
}

}  // namespace

PointClasses point_classes(std::span<const PointClass> classes, const MortonOrder& order,
                           std::span<const PointScore> scores) {
  if (classes.empty()) return {};
  std::array<Sums, 5> sums;  // by PointClass
  for (std::size_t k = 0; k < scores.size(); ++k)
    sums[static_cast<std::size_t>(classes[order.entries[k].index])].add(scores[k].distance);
  const auto& [unknown, world, mover, air, ghost] = sums;
  PointClasses result;
  result.points = world.points + mover.points + air.points + ghost.points;
  result.world = figures_of(world, result.points);
  result.mover = figures_of(mover, result.points);
  result.air = figures_of(air, result.points);
  result.ghost = figures_of(ghost, result.points);
  return result;
}

}  // namespace lidarena::evaluation
