// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "lidarena/base/scan.hpp"

namespace lidarena::estimation {

/// How the points of a scan become rows of neighbors.
struct ImageLayout {
  /// Columns are intervals of azimuth, whose first point stays; false: the firing order of the row,
  /// for patterns that do not repeat.
  bool by_azimuth = true;
  int columns = 1800;  ///< number of intervals of azimuth
  int row_stride = 1;  ///< every n-th row is used
  double min_range_m = 0.0;
  double max_range_m = 1000.0;
};

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

/// Whether a point is finite, within the range limits and in a row that is used.
bool is_usable(const Point& point, const ImageLayout& layout);

/// Sorts the usable points of a scan into rows by ring, and columns. `positions` are the de-skewed
/// positions of all points of the scan.
RangeImage project(const Scan& scan, std::span<const Eigen::Vector3f> positions,
                   const ImageLayout& layout);

}  // namespace lidarena::estimation
