// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <utility>

#include "lidarena/base/config.hpp"

namespace lidarena::map {

/// Orientation of a voxel grid in the frame of its points. Where a wall lies along a border between
/// cells, range noise divides its points between two layers of cells. Each cell has one mean,
/// however few points it has, so the average of the means lies off the wall, and farther off the
/// more points there are: a scan is aligned beside a map made of many such scans. With walls
/// parallel to the grid this happens in the same way over whole walls. In a rotated grid a wall
/// crosses its cells at all heights, and the error averages out.
enum class GridAxes {
  kParallel,  ///< axes parallel to the frame's
  kRotated,   ///< rotated grid: no axis within 23 degrees of an axis of the frame
};

constexpr auto enum_names(GridAxes) {
  return std::array{std::pair{"parallel", GridAxes::kParallel},
                    std::pair{"rotated", GridAxes::kRotated}};
}

/// Rotation from the frame of the points to that of the grid.
inline Eigen::Matrix3d grid_from_points(GridAxes axes) {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  if (axes == GridAxes::kParallel) return Eigen::Matrix3d::Identity();
  return (AngleAxisd(0.5, Vector3d::UnitZ()) * AngleAxisd(0.6, Vector3d::UnitY()) *
          AngleAxisd(0.4, Vector3d::UnitX()))
      .toRotationMatrix();
}

}  // namespace lidarena::map
