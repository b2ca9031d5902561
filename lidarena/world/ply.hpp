// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "lidarena/world/triangle_mesh.hpp"

/// Surfaces in the Polygon File Format (G. Turk, "The PLY Polygon File Format", 1994). Implemented
/// here and not by the mesh importer, because coordinates must be kept in double precision.
namespace lidarena::world {

/// Reads vertices (x, y, z) and faces (vertex_indices or vertex_index) of an ASCII or binary PLY
/// file and skips everything else. Polygons are split into triangle fans, so they must be convex.
/// Throws InputError with the file and, in the header, the line when it is not a PLY file, is
/// truncated, or has an invalid index. A file of points gives a mesh without triangles. Materials
/// are read from files that save_ply() wrote: comments "material REFLECTIVITY SPECULAR NAME", or
/// "material REFLECTIVITY SPECULAR transmission=T retro=R NAME", each with "object KIND" after it
/// if it is of a named kind of object, and the face property material_index.
TriangleMesh read_ply(const std::filesystem::path& file);

/// Writes binary little-endian PLY with double coordinates, and materials if the mesh has them;
/// read_ply() restores exactly the same values.
/// The file appears under its name only once it is complete. Throws Error if it cannot be written.
void save_ply(const std::filesystem::path& file, const TriangleMesh& mesh);

}  // namespace lidarena::world
