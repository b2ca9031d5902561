// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "lidarena/base/time.hpp"

namespace lidarena {

/// One return of a LiDAR, 24 bytes.
struct Point {
  Eigen::Vector3f position =
      Eigen::Vector3f::Zero();  ///< m, lidar frame at the point's own instant
  float intensity = 0.0F;       ///< sensor's own scale; simulated sensors give 0..255
  std::int32_t dt_ns = 0;       ///< ns since Scan::stamp
  std::uint16_t ring = 0;       ///< row of a spinning sensor, laser line of a Livox
  std::uint8_t echo = 0;        ///< 0 = first return
  std::uint8_t lidar = 0;       ///< which of the LiDARs in Scan::origins
};
static_assert(sizeof(Point) == 24);

/// One sweep. Shots without a return are left out.
struct Scan {
  Time stamp{0};              ///< instant of the sweep's first firing; `dt_ns` counts from here
  std::vector<Point> points;  ///< in firing order
  bool timed = true;          ///< false: the source carried no per-point times, `dt_ns` is all zero
  /// Places of the LiDARs that made the scan (m), in the frame of its points; empty: one, at zero.
  std::vector<Eigen::Vector3f> origins{};
};

/// Instant of a point of `scan`.
inline Time time_of(const Scan& scan, const Point& point) { return scan.stamp + Time{point.dt_ns}; }

/// Place (m) of the LiDAR that measured the point, in the frame of the scan.
inline Eigen::Vector3f origin_of(const Scan& scan, const Point& point) {
  return scan.origins.empty() ? Eigen::Vector3f(Eigen::Vector3f::Zero())
                              : scan.origins[point.lidar];
}

/// Instant of the last firing among the points; the stamp for an empty scan.
inline Time end_of(const Scan& scan) {
  std::int32_t last = 0;
  for (const Point& point : scan.points) last = point.dt_ns > last ? point.dt_ns : last;
  return scan.stamp + Time{last};
}

}  // namespace lidarena
