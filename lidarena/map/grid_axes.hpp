// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <utility>

#include "lidarena/base/config.hpp"

namespace lidarena {

/// How a grid lies in the frame of its points. Of a wall that runs along a border of cells, the
/// range noise falls into two layers; each cell is one vote, however few its points, so the mean of
/// the votes lies off the wall, and farther off the more points there are: a scan comes to rest
/// beside a map made of many like it. When walls are parallel to the grid that happens over whole
/// walls alike. Askew, a wall crosses its cells at all heights, and it averages out.
enum class GridAxes {
  kParallel,  ///< to the frame's axes
  kAskew,     ///< no axis nearer than 23 degrees to one of them, nor so to walls that lie along them
};

template <>
struct EnumNames<GridAxes> {
  static constexpr std::array names{std::pair{"parallel", GridAxes::kParallel},
                                    std::pair{"askew", GridAxes::kAskew}};
};

/// From the frame of the points to that of the grid.
inline Eigen::Matrix3d grid_turn(GridAxes axes) {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  if (axes == GridAxes::kParallel) return Eigen::Matrix3d::Identity();
  return (AngleAxisd(0.5, Vector3d::UnitZ()) * AngleAxisd(0.6, Vector3d::UnitY()) *
          AngleAxisd(0.4, Vector3d::UnitX()))
      .toRotationMatrix();
}

}  // namespace lidarena
