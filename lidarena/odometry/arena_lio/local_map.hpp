// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "lidarena/map/plane_map.hpp"
#include "lidarena/odometry/arena_lio/config.hpp"

namespace lidarena::odometry::arena_lio {

/// The planes around the sensor, in cells of two sizes (m, map frame): the coarse ones serve where
/// points are too sparse, or the pose too uncertain, for the fine ones.
class LocalMap {
 public:
  explicit LocalMap(const Config& config);

  /// `points`: all of a scan; `reduced`: their averages.
  void insert(std::span<const Eigen::Vector3f> points, std::span<const Eigen::Vector3f> reduced);
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
