// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/world/triangle_mesh.hpp"

namespace lidarena::report {

/// A coarser mesh for pictures: vertices in the same cell of a grid are merged, with cells doubled
/// until at most `max_triangles` are left (J. Rossignac, P. Borrel, "Multi-resolution 3D
/// approximations for rendering complex scenes", 1993). A mesh that is small enough is unchanged.
world::TriangleMesh simplified(const world::TriangleMesh& mesh, std::size_t max_triangles);

}  // namespace lidarena::report
