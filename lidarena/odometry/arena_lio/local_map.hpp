// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "lidarena/map/kd_tree.hpp"
#include "lidarena/odometry/arena_lio/plane_residuals.hpp"

namespace lidarena::odometry::arena_lio {

/// Adds a scan's points (m, world) to the map, which keeps the point nearest to the center of each
/// cell. `nearest` are those of the points' last search; empty if there was none.
void add_scan(std::span<const Eigen::Vector3f> points, std::span<const Nearest> nearest,
              float voxel, map::KdTree& map);

/// Removes points outside the box of half edge `radius` (m) around the sensor, each time the sensor
/// has moved by a quarter of that.
class MapWindow {
 public:
  explicit MapWindow(double radius) : radius_(static_cast<float>(radius)) {}
  void follow(const Eigen::Vector3f& sensor, map::KdTree& map);

 private:
  float radius_;
  Eigen::Vector3f center_ = Eigen::Vector3f::Zero();
};

}  // namespace lidarena::odometry::arena_lio
