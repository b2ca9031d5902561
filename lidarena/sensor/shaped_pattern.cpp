// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/shaped_pattern.hpp"

#include <algorithm>
#include <cmath>

#include "lidarena/base/angle.hpp"

namespace lidarena::sensor {
namespace {

Eigen::Vector3f mapped(const Eigen::Vector3f& direction, const ElevationMap& map) {
  const Eigen::Vector3d d = direction.cast<double>();
  const double azimuth = std::atan2(d.y(), d.x());
  const double elevation = std::atan2(d.z(), std::hypot(d.x(), d.y())) / kDegree;
  const double to = kDegree * std::clamp(map(elevation), -90.0, 90.0);
  return Eigen::Vector3d(std::cos(azimuth) * std::cos(to), std::sin(azimuth) * std::cos(to),
                         std::sin(to))
      .cast<float>();
}

}  // namespace

void ShapedPattern::beams(std::uint64_t index, std::vector<Beam>& out) const {
  pattern_->beams(repetitive_ ? 0 : index, out);
  if (map_.is_identity()) return;
  for (Beam& beam : out) beam.direction = mapped(beam.direction, map_);
}

}  // namespace lidarena::sensor
