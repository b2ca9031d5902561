// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <span>

#include "lidarena/map/kd_tree.hpp"
#include "lidarena/odometry/fast_lio2/plane_residuals.hpp"

namespace lidarena::odometry::fast_lio2 {

/// Adds a scan's points (m, world) to the map (section V-E): those that need downsampling first,
/// then those whose cell their `neighbors` show to be empty.
void insert_scan(std::span<const Eigen::Vector3f> points, std::span<const Neighbors> neighbors,
                 float voxel, map::KdTree& map);

/// The box of the map (section V-A): a cube with an edge of `size` (m), at first around the sensor.
/// When the sensor comes within 1.5 times `range` (m) of a face, the box moves on along that axis,
/// and the slab that it leaves is removed from the map.
class MapBox {
 public:
  MapBox(double size, double range)
      : size_(static_cast<float>(size)), range_(static_cast<float>(range)) {}
  void follow(const Eigen::Vector3f& sensor, map::KdTree& map);
  const Eigen::AlignedBox3f& box() const { return box_; }  ///< m, world; empty before the start

 private:
  float size_;
  float range_;
  Eigen::AlignedBox3f box_;
};

}  // namespace lidarena::odometry::fast_lio2
