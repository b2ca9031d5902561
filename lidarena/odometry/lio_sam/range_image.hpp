// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "lidarena/base/scan.hpp"
#include "lidarena/odometry/lio_sam/config.hpp"

namespace lidarena::lio_sam {

/// A point with its place in the image.
struct Pixel {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< m, de-skewed
  float range = 0.0F;                                  ///< m, as measured
  int column = 0;
};

/// A scan as rows of points that neighbor each other; empty cells are left out.
struct RangeImage {
  std::vector<Pixel> pixels;         ///< row by row, by column
  std::vector<std::size_t> row_end;  ///< index of the pixel after each row
  std::span<const Pixel> row(std::size_t index) const {
    const std::size_t begin = index == 0 ? 0 : row_end[index - 1];
    return std::span(pixels).subspan(begin, row_end[index] - begin);
  }
};

/// Sorts a scan's points into rows by ring and columns by azimuth or order of firing, those alone
/// that are finite and within the ranges. `positions` are the de-skewed ones of all points.
RangeImage project(const Scan& scan, std::span<const Eigen::Vector3f> positions,
                   const Config& config);

}  // namespace lidarena::lio_sam
