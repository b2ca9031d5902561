// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "lidarena/base/time.hpp"
#include "lidarena/world/surfaces.hpp"

namespace lidarena::sensor {

/// A surface that a ray reaches by way of other surfaces that mirror it or let it pass.
struct PathEnd {
  double length = 0.0;    ///< m, along the path from the ray's origin
  double share = 0.0;     ///< of the light that comes back along the path
  bool mirrored = false;  ///< at one surface at least
  double cosine = 0.0;    ///< of the incidence
  world::Hit hit;
};

/// Share of the light that goes into a surface, relative to normal incidence: 1 - mirrored_share(),
/// normalized.
double entering_share(const world::Material& material, double cos_incidence);

/// Appends to `ends` what a ray reaches beyond its first hit, by way of at most `bounces` surfaces
/// that mirror or let pass, up to `max_length` m. Light comes back the way it went, so a share
/// counts twice: mirrored_share() squared, or (transmission * entering_share()) squared. Ways that
/// bring back less than a thousandth are left out. Geometric optics; a pane does not refract (1 cm
/// of glass shifts a ray by up to 3 mm), and what is mirrored is mirrored as by a plane mirror.
/// The ghosts that result are those of Yun, Sim, "Reflection removal for large-scale 3D point
/// clouds" (CVPR 2018), and Koch et al., "Detection and purging of specular reflective and
/// transparent object influences in 3D range measurements" (ISPRS Archives 2017).
void follow_light(const world::Surfaces& world, Time t, const world::Ray& ray,
                  const world::Hit& first, int bounces, double max_length,
                  std::vector<PathEnd>& ends);

}  // namespace lidarena::sensor
