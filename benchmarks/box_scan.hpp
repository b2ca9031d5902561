// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "lidarena/base/random.hpp"
#include "lidarena/base/scan.hpp"

/// Scans of a box, for benchmarks.
namespace lidarena::box {

inline const Eigen::Array3d kHalf(8.0, 6.0, 2.0);  // m, half of its edges

/// A scan of 0.1 s at rest in the middle of the box, uniform over the sphere, with 2 cm of noise.
/// Of 131,072 points, 128 share their time, as those of a column of an OS0-128 do.
inline Scan scan_of(std::size_t count, std::uint64_t seed) {
  const CounterRandom random(seed);
  const std::size_t at_once = count == 131'072 ? 128 : 1;
  Scan scan{.stamp = Time{0}, .points = {}, .timed = true};
  for (std::size_t i = 0; i < count; ++i) {
    const double z = 2.0 * random.uniform(i, 0) - 1.0;
    const double azimuth = 2.0 * M_PI * random.uniform(i, 1);
    const double radius = std::sqrt(1.0 - z * z);
    const Eigen::Vector3d beam(radius * std::cos(azimuth), radius * std::sin(azimuth), z);
    const double range = (kHalf / beam.array().abs()).minCoeff() + 0.02 * random.normals(i, 2)[0];
    const double share = static_cast<double>(i / at_once * at_once) / static_cast<double>(count);
    scan.points.push_back(
        {(range * beam).cast<float>(), 0, static_cast<std::int32_t>(1e8 * share)});
  }
  return scan;
}

/// Positions (m) of its points, in order.
inline std::vector<Eigen::Vector3f> positions(const Scan& scan) {
  std::vector<Eigen::Vector3f> points;
  for (const Point& point : scan.points) points.push_back(point.position);
  return points;
}

}  // namespace lidarena::box
