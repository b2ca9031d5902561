// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>

namespace lidarena {

enum class SurfaceKind { kIntoGlass, kIntoAir, kMirror };

/// A plane that a ray meets: a face of a wedge, or a mirror, on a turning rotor. Its normal leans
/// from the optical axis (+z) by the tilt, towards the rotor's present phase.
struct Surface {
  SurfaceKind kind;
  int rotor;  ///< index among the phases given to trace()
  double sin_tilt;
  double cos_tilt;
};

/// `tilt_deg` in degrees, as designs are written down.
Surface make_surface(SurfaceKind kind, int rotor, double tilt_deg);

/// Unit direction (air) in which a ray that starts with the unit direction `ray` leaves the chain
/// of `surfaces`. `phases` are (cos, sin) of each rotor's angle; `glass_index` is the refractive
/// index. Snell's law with momentum vectors: the length is 1 in air and the index in glass, and a
/// face changes only the part along its normal.
Eigen::Vector3d trace(std::span<const Surface> surfaces, double glass_index,
                      std::span<const Eigen::Vector2d> phases, Eigen::Vector3d ray);

}  // namespace lidarena
