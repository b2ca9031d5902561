// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "lidarena/world/triangle_mesh.hpp"

namespace lidarena::world {

/// Triangles that cover a simple polygon, given by its corners (indices into `vertices`), with its
/// orientation. A convex polygon gives the fan around its first corner; others are cut ear by ear
/// (G. H. Meisters, "Polygons have ears", 1975), in the plane of their mean normal (Newell's). A
/// polygon that crosses itself, or has no area, gives a fan.
std::vector<Triangle> triangulate(std::span<const std::uint32_t> corners,
                                  std::span<const Eigen::Vector3d> vertices);

}  // namespace lidarena::world
