// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/scenes/sparse_field.hpp"
#include "lidarena/world/triangle_mesh.hpp"

namespace lidarena::scenes {

/// Changes single samples from rock to free space until the set of free samples is well composed
/// (Latecki, "3D well-composed pictures", GMIP 1997): no face of a grid cell is a checkerboard and
/// no cell has only two opposite corners of one kind. Then the surface between free space and rock,
/// and hence the surface net, is a 2-manifold. Returns the number of samples changed.
std::size_t make_well_composed(SparseField& field);

/// The zero surface as a surface net (Gibson, "Constrained elastic surface nets", MICCAI 1998): one
/// vertex in each grid cell that the surface passes through, at the mean of its crossings with the
/// cell's edges, and one quad, split along its shorter diagonal, at each grid edge that it crosses.
/// Normals (right-hand rule) point into free space. The field must be well composed, and its blocks
/// must cover every cell that the surface passes through.
world::TriangleMesh surface_net(const SparseField& field);

}  // namespace lidarena::scenes
