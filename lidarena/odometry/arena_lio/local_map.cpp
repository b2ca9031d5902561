// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lio/local_map.hpp"

namespace lidarena::odometry::arena_lio {
namespace {

constexpr double kCoarseCells = 3.0;   // edge, in edges of the fine cells
constexpr int kCoarsePoints = 10'000;  // of a scan

map::PlaneMap plane_map(const Config& config, double scale) {
  return map::PlaneMap(
      {.cell_size = scale * config.map_cell_size_m, .max_points = config.max_cell_points});
}

}  // namespace

std::vector<Eigen::Vector3f> evenly(std::vector<Eigen::Vector3f> points, int most) {
  const auto count = static_cast<std::size_t>(most);
  if (points.size() <= count) return points;
  for (std::size_t i = 0; i < count; ++i) points[i] = points[i * points.size() / count];
  points.resize(count);
  return points;
}

LocalMap::LocalMap(const Config& config)
    : radius_(static_cast<float>(config.map_radius_m)),
      fine_(plane_map(config, 1.0)),
      coarse_(plane_map(config, kCoarseCells)) {}

void LocalMap::insert(std::span<const Eigen::Vector3f> points) {
  fine_.insert(points);
  coarse_.insert(evenly({points.begin(), points.end()}, kCoarsePoints));
}

void LocalMap::clear() {
  fine_.clear();
  coarse_.clear();
}

void LocalMap::follow(const Eigen::Vector3f& sensor) {
  if ((sensor - center_).cwiseAbs().maxCoeff() < 0.25F * radius_) return;
  center_ = sensor;
  fine_.remove_far(center_, radius_);
  coarse_.remove_far(center_, radius_);
}

}  // namespace lidarena::odometry::arena_lio
