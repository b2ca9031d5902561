// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/map/local_planes.hpp"

namespace lidarena::map {
namespace {

constexpr double kCoarseCells = 3.0;   // edge, in edges of the fine cells
constexpr int kCoarsePoints = 10'000;  // of a scan

PlaneMap plane_map(const LocalPlanes::Options& options, double scale) {
  return PlaneMap({.cell_size = scale * options.cell_size, .max_points = options.max_points});
}

}  // namespace

std::vector<Eigen::Vector3f> evenly(std::vector<Eigen::Vector3f> points, int most) {
  const auto count = static_cast<std::size_t>(most);
  if (points.size() <= count) return points;
  for (std::size_t i = 0; i < count; ++i) points[i] = points[i * points.size() / count];
  points.resize(count);
  return points;
}

LocalPlanes::LocalPlanes(const Options& options)
    : radius_(static_cast<float>(options.radius)),
      fine_(plane_map(options, 1.0)),
      coarse_(plane_map(options, kCoarseCells)) {}

void LocalPlanes::insert(std::span<const Eigen::Vector3f> points, const PlaneMap::Sensor& sensor) {
  fine_.insert(points, sensor);
  coarse_.insert(evenly({points.begin(), points.end()}, kCoarsePoints), sensor);
}

void LocalPlanes::clear() {
  fine_.clear();
  coarse_.clear();
}

void LocalPlanes::follow(const Eigen::Vector3f& sensor) {
  if ((sensor - center_).cwiseAbs().maxCoeff() < 0.25F * radius_) return;
  center_ = sensor;
  fine_.remove_far(center_, radius_);
  coarse_.remove_far(center_, radius_);
}

const MapPlane* LocalPlanes::plane_at(const Eigen::Vector3f& point, const PlaneMap::Sensor& sensor,
                                      bool coarse_first) const {
  const MapPlane* plane = (coarse_first ? coarse_ : fine_).plane_at(point, sensor);
  return plane != nullptr ? plane : (coarse_first ? fine_ : coarse_).plane_at(point, sensor);
}

}  // namespace lidarena::map
