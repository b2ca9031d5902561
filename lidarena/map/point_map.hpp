// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "lidarena/map/occupied_voxels.hpp"

namespace lidarena::map {

/// A point cloud with at most one point per voxel, in insertion order: the first point of a voxel
/// is kept, later ones are rejected. Nothing is averaged, so noise stays visible.
class PointMap {
 public:
  /// `voxel_size` in m; memory for `expected` points is reserved at once.
  explicit PointMap(double voxel_size, std::size_t expected = 0) : voxels_(voxel_size) {
    points_.reserve(expected);
  }

  /// Adds `point` (m) if it is finite and the first of its voxel; returns whether it was added.
  bool insert(const Eigen::Vector3f& point);
  /// The same for many points, several times faster.
  void insert(std::span<const Eigen::Vector3f> points);

  std::span<const Eigen::Vector3f> points() const { return points_; }
  /// Returns the points and leaves the map empty.
  std::vector<Eigen::Vector3f> take();

  std::size_t size() const { return points_.size(); }
  std::size_t memory_bytes() const {
    return points_.capacity() * sizeof(Eigen::Vector3f) + voxels_.memory_bytes();
  }

 private:
  OccupiedVoxels voxels_;
  std::vector<Eigen::Vector3f> points_;
  std::vector<std::uint32_t> added_;  ///< of the last call
};

}  // namespace lidarena::map
