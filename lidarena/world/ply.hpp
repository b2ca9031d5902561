// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "lidarena/world/triangle_mesh.hpp"

/// Surfaces in the Polygon File Format (G. Turk, "The PLY Polygon File Format", 1994), read and
/// written by ourselves because coordinates must stay double.
namespace lidarena {

/// Reads vertices (x, y, z) and faces (vertex_indices or vertex_index) of an ASCII or binary PLY
/// file and skips everything else. Polygons are cut into fans, so they must be convex. Throws
/// InputError naming file and place when it is not such a file, ends early, or an index is wrong; a
/// file of points gives a mesh without triangles. Materials are read from files that save_ply()
/// wrote: comments "material REFLECTIVITY SPECULAR NAME" and the face property material_index.
TriangleMesh read_ply(const std::filesystem::path& file);

/// Writes binary little endian PLY with double coordinates, and materials where the mesh has them;
/// read_ply() gives the same bits back.
/// The file appears under its name only once it is whole. Throws Error when it cannot be written.
void save_ply(const std::filesystem::path& file, const TriangleMesh& mesh);

}  // namespace lidarena
