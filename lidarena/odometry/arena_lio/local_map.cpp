// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lio/local_map.hpp"

#include <limits>

#include "lidarena/map/cell_insertion.hpp"

namespace lidarena::odometry::arena_lio {

void add_scan(std::span<const Eigen::Vector3f> points, std::span<const Nearest> nearest,
              float voxel, map::KdTree& map) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto insertion = nearest.empty()
                               ? map::CellInsertion::kThinned
                               : map::cell_insertion(points[i], nearest[i].neighbors(), voxel);
    if (insertion == map::CellInsertion::kPlain) map.insert(points[i]);
    if (insertion == map::CellInsertion::kThinned) map.insert_downsampled(points[i], voxel);
  }
}

void MapWindow::follow(const Eigen::Vector3f& sensor, map::KdTree& map) {
  if ((sensor - center_).cwiseAbs().maxCoeff() < 0.25F * radius_) return;
  center_ = sensor;
  constexpr float kFar = std::numeric_limits<float>::max();
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    Eigen::AlignedBox3f below(Eigen::Vector3f::Constant(-kFar), Eigen::Vector3f::Constant(kFar));
    Eigen::AlignedBox3f above = below;
    below.max()[axis] = center_[axis] - radius_;
    above.min()[axis] = center_[axis] + radius_;
    map.remove(below);
    map.remove(above);
  }
}

}  // namespace lidarena::odometry::arena_lio
