// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_slam/range_image.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace lidarena::odometry::arena_slam {
namespace {

using Indices = std::vector<std::uint32_t>;

/// Indices of the usable points of each ring, in their order.
std::vector<Indices> by_ring(const Scan& scan, const Config& config) {
  std::vector<Indices> rings;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const Point& point = scan.points[i];
    const auto range = static_cast<double>(point.position.norm());
    const bool usable = range >= config.min_range_m && range <= config.max_range_m;
    if (!usable || point.ring % config.row_stride != 0) continue;  // NaN is not usable
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

RangeImage project(const Scan& scan, std::span<const Eigen::Vector3f> positions,
                   const Config& config) {
  RangeImage image;
  image.pixels.reserve(scan.points.size());
  constexpr std::uint32_t kEmpty = 0xFFFFFFFFU;
  Indices cells;
  for (const Indices& ring : by_ring(scan, config)) {
    const auto add = [&](std::uint32_t point, int column) {
      image.pixels.push_back({positions[point], scan.points[point].position.norm(), column});
    };
    if (config.columns_by == Columns::kArrival) {
      for (std::size_t k = 0; k < ring.size(); ++k) add(ring[k], static_cast<int>(k));
    } else {
      cells.assign(static_cast<std::size_t>(config.columns), kEmpty);
      for (const std::uint32_t point : ring) {
        const int column = azimuth_column(scan.points[point].position, config.columns);
        std::uint32_t& cell = cells[static_cast<std::size_t>(column)];
        if (cell == kEmpty) cell = point;
      }
      for (std::size_t k = 0; k < cells.size(); ++k) {
        if (cells[k] != kEmpty) add(cells[k], static_cast<int>(k));
      }
    }
    image.row_end.push_back(image.pixels.size());
  }
  return image;
}

}  // namespace lidarena::odometry::arena_slam
