// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "lidarena/base/scan.hpp"
#include "lidarena/odometry/arena_slam/config.hpp"

namespace lidarena::odometry::arena_slam {

/// A point and its column in the image.
struct Pixel {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< m, de-skewed
  float range = 0.0F;                                  ///< m, as measured
  int column = 0;
};

/// A scan as rows of neighboring points, without the empty cells.
struct RangeImage {
  std::vector<Pixel> pixels;         ///< sorted by row, then by column
  std::vector<std::size_t> row_end;  ///< index of the pixel after each row
  std::span<const Pixel> row(std::size_t index) const {
    const std::size_t begin = index == 0 ? 0 : row_end[index - 1];
    return std::span(pixels).subspan(begin, row_end[index] - begin);
  }
};

/// Sorts a scan's finite points within the range limits into rows by ring and columns by azimuth or
/// firing order. `positions` are the de-skewed positions of all points of the scan.
RangeImage project(const Scan& scan, std::span<const Eigen::Vector3f> positions,
                   const Config& config);

}  // namespace lidarena::odometry::arena_slam
