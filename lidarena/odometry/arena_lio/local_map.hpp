// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "lidarena/map/plane_map.hpp"
#include "lidarena/odometry/arena_lio/config.hpp"

namespace lidarena::odometry::arena_lio {

/// At most `most` of the points, at even intervals of their order.
std::vector<Eigen::Vector3f> evenly(std::vector<Eigen::Vector3f> points, int most);

/// The planes around the sensor, in cells of two sizes (m, map frame): the coarse ones serve where
/// points are too sparse, or the pose too uncertain, for the fine ones.
class LocalMap {
 public:
  explicit LocalMap(const Config& config);

  /// Adds all points of a scan; to the coarse cells, which need fewer, an even selection.
  void insert(std::span<const Eigen::Vector3f> points);
  void clear();
  /// Removes what is far from the sensor, each time it has moved by a quarter of the radius.
  void follow(const Eigen::Vector3f& sensor);

  const map::PlaneMap& fine() const { return fine_; }
  const map::PlaneMap& coarse() const { return coarse_; }
  bool empty() const { return coarse_.empty(); }
  std::uint64_t memory_bytes() const { return fine_.memory_bytes() + coarse_.memory_bytes(); }

 private:
  float radius_;
  Eigen::Vector3f center_ = Eigen::Vector3f::Zero();
  map::PlaneMap fine_;
  map::PlaneMap coarse_;
};

}  // namespace lidarena::odometry::arena_lio
