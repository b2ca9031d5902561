// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/optics.hpp"

#include <cmath>
#include <numbers>

namespace lidarena::sensor {

Surface make_surface(SurfaceKind kind, int rotor, double tilt_deg) {
  const double tilt = tilt_deg * std::numbers::pi / 180.0;
  return {kind, rotor, std::sin(tilt), std::cos(tilt)};
}

Eigen::Vector3d trace(std::span<const Surface> surfaces, double glass_index,
                      std::span<const Eigen::Vector2d> phases, Eigen::Vector3d ray) {
  const double gain = glass_index * glass_index - 1.0;  // increase of |ray|^2 from air to glass
  for (const Surface& surface : surfaces) {
    const Eigen::Vector2d& phase = phases[static_cast<std::size_t>(surface.rotor)];
    const Eigen::Vector3d normal(surface.sin_tilt * phase.x(), surface.sin_tilt * phase.y(),
                                 surface.cos_tilt);
    const double along = ray.dot(normal);
    switch (surface.kind) {
      case SurfaceKind::kIntoGlass:
        ray += (std::sqrt(along * along + gain) - along) * normal;
        break;
      case SurfaceKind::kIntoAir:
        ray += (std::sqrt(along * along - gain) - along) * normal;
        break;
      case SurfaceKind::kMirror:
        ray -= 2.0 * along * normal;
        break;
    }
  }
  return ray;
}

}  // namespace lidarena::sensor
