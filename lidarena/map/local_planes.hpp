// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "lidarena/map/plane_map.hpp"

namespace lidarena::map {

/// At most `most` of the points, at even intervals of their order.
std::vector<Eigen::Vector3f> evenly(std::vector<Eigen::Vector3f> points, int most);

/// The planes around a sensor, in cells of two sizes (m, map frame): the coarse ones, of three
/// times the edge, serve where points are too sparse, or the pose too uncertain, for the fine ones.
class LocalPlanes {
 public:
  struct Options {
    double cell_size = 0.3;  ///< edge of a fine cell, m
    int max_points = 400;    ///< of a cell
    double radius = 150.0;   ///< half the edge of the box around the sensor that is kept, m
  };

  explicit LocalPlanes(const Options& options);

  /// Adds all points of a scan; to the coarse cells, which need fewer, an even selection.
  /// `sensor` (m): from where they were seen, which tells the sides of a wall apart.
  void insert(std::span<const Eigen::Vector3f> points,
              const PlaneMap::Sensor& sensor = std::nullopt);
  void clear();
  /// Removes what is far from the sensor, each time it has moved by a quarter of the radius.
  void follow(const Eigen::Vector3f& sensor);

  /// The plane at `point` that is seen from `sensor` (m), of a fine cell, or of a coarse one where
  /// the fine one has none; the other way round with `coarse_first`.
  const MapPlane* plane_at(const Eigen::Vector3f& point, const PlaneMap::Sensor& sensor,
                           bool coarse_first) const;

  const PlaneMap& fine() const { return fine_; }
  const PlaneMap& coarse() const { return coarse_; }
  bool empty() const { return coarse_.empty(); }
  std::uint64_t memory_bytes() const { return fine_.memory_bytes() + coarse_.memory_bytes(); }

 private:
  float radius_;
  Eigen::Vector3f center_ = Eigen::Vector3f::Zero();
  PlaneMap fine_;
  PlaneMap coarse_;
};

}  // namespace lidarena::map
