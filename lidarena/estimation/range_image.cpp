// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/range_image.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace lidarena::estimation {
namespace {

using Indices = std::vector<std::uint32_t>;

constexpr std::uint32_t kEmpty = 0xFFFFFFFFU;

/// Indices of the usable points of each ring, in their order.
std::vector<Indices> by_ring(const Scan& scan, const ImageLayout& layout) {
  std::vector<Indices> rings;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const Point& point = scan.points[i];
    if (!is_usable(point, layout)) continue;
    if (point.ring >= rings.size()) rings.resize(point.ring + std::size_t{1});
    rings[point.ring].push_back(static_cast<std::uint32_t>(i));
  }
  return rings;
}

int azimuth_column(const Eigen::Vector3f& position, int columns) {
  const double turns = std::atan2(position.y(), position.x()) / (2.0 * std::numbers::pi) + 0.5;
  return std::min(static_cast<int>(turns * columns), columns - 1);
}

}  // namespace

bool is_usable(const Point& point, const ImageLayout& layout) {
  const auto range = static_cast<double>(point.position.norm());
  const bool within = range >= layout.min_range_m && range <= layout.max_range_m;
  return within && point.ring % layout.row_stride == 0;  // NaN is not within
}

RangeImage project(const Scan& scan, std::span<const Eigen::Vector3f> positions,
                   const ImageLayout& layout) {
  RangeImage image;
  image.pixels.reserve(scan.points.size());
  Indices cells;
  for (const Indices& ring : by_ring(scan, layout)) {
    const auto add = [&](std::uint32_t point, std::size_t column) {
      image.pixels.push_back(
          {positions[point], scan.points[point].position.norm(), static_cast<int>(column)});
    };
    if (layout.by_azimuth) {
      cells.assign(static_cast<std::size_t>(layout.columns), kEmpty);
      for (const std::uint32_t point : ring) {
        const int column = azimuth_column(scan.points[point].position, layout.columns);
        std::uint32_t& cell = cells[static_cast<std::size_t>(column)];
        if (cell == kEmpty) cell = point;
      }
      for (std::size_t k = 0; k < cells.size(); ++k) {
        if (cells[k] != kEmpty) add(cells[k], k);
      }
    } else {
      for (std::size_t k = 0; k < ring.size(); ++k) add(ring[k], k);
    }
    image.row_end.push_back(image.pixels.size());
  }
  return image;
}

}  // namespace lidarena::estimation
