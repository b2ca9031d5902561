// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/fast_lio2/local_map.hpp"

#include <algorithm>

#include "lidarena/map/cell_insertion.hpp"

namespace lidarena::odometry::fast_lio2 {

void insert_scan(std::span<const Eigen::Vector3f> points, std::span<const Neighbors> neighbors,
                 float voxel, map::KdTree& map) {
  std::vector<Eigen::Vector3f> plain;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const map::CellInsertion how = map::cell_insertion(points[i], neighbors[i], voxel);
    if (how == map::CellInsertion::kThinned) map.insert_downsampled(points[i], voxel);
    if (how == map::CellInsertion::kPlain) plain.push_back(points[i]);
  }
  for (const Eigen::Vector3f& point : plain) map.insert(point);
}

void MapBox::follow(const Eigen::Vector3f& sensor, map::KdTree& map) {
  const Eigen::Vector3f half = Eigen::Vector3f::Constant(0.5F * size_);
  if (box_.isEmpty()) box_ = {sensor - half, sensor + half};
  const float margin = 1.5F * range_;
  const float shift = std::max(0.45F * (size_ - 2.0F * margin), 0.5F * range_);
  const Eigen::AlignedBox3f before = box_;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    Eigen::AlignedBox3f left = before;
    if (sensor[axis] - before.min()[axis] <= margin) {
      box_.translate(-shift * Eigen::Vector3f::Unit(axis));
      left.min()[axis] = before.max()[axis] - shift;
    } else if (before.max()[axis] - sensor[axis] <= margin) {
      box_.translate(shift * Eigen::Vector3f::Unit(axis));
      left.max()[axis] = before.min()[axis] + shift;
    } else {
      continue;
    }
    map.remove(left);
  }
}

}  // namespace lidarena::odometry::fast_lio2
