// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>

namespace lidarena::sensor {

enum class SurfaceKind { kIntoGlass, kIntoAir, kMirror };

/// Plane optical surface on a rotor: a face of a wedge, or a mirror. Its normal is tilted from the
/// optical axis (+z) towards the rotor's current phase angle.
struct Surface {
  SurfaceKind kind;
  int rotor;  ///< index among the phases given to trace()
  double sin_tilt;
  double cos_tilt;
};

/// Makes a surface from its tilt in degrees.
Surface make_surface(SurfaceKind kind, int rotor, double tilt_deg);

/// Traces a ray with unit direction `ray` through the `surfaces` in order and returns its unit
/// direction behind them (in air). `phases` are (cos, sin) of each rotor's angle; `glass_index` is
/// the refractive index. Snell's law in vector form: the ray vector has length 1 in air and the
/// refractive index in glass; a face changes only its component along the normal.
Eigen::Vector3d trace(std::span<const Surface> surfaces, double glass_index,
                      std::span<const Eigen::Vector2d> phases, Eigen::Vector3d ray);

}  // namespace lidarena::sensor
