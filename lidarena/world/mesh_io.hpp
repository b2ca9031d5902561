// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lidarena/base/config.hpp"
#include "lidarena/world/triangle_mesh.hpp"

namespace lidarena {

/// Which coordinate of a mesh file points up.
enum class UpAxis {
  kFile,  ///< as the format says: glTF is y up, DAE says so in <up_axis>; all others z up
  kY,     ///< y, whatever the file says; turned to z
  kZ,     ///< z, whatever the file says: coordinates as they stand, as Gazebo takes them
};
template <>
struct EnumNames<UpAxis> {
  static constexpr std::array names{std::pair{"file", UpAxis::kFile}, std::pair{"y", UpAxis::kY},
                                    std::pair{"z", UpAxis::kZ}};
};

/// One surface of a mesh file, with the names by which an SDF <submesh> may ask for it.
struct MeshPart {
  std::string node;  ///< node of the scene graph that places it; empty where the format has none
  std::string name;
  TriangleMesh surface;
};

/// True for the endings that load_mesh() reads (.obj .ply .stl .dae .gltf .glb, in any case).
bool is_mesh_file(const std::filesystem::path& file);

/// The surfaces of a mesh file in meters, z up: node transforms and DAE units are applied, polygons
/// cut into triangles, points and lines left out, equal vertices made one (but in PLY, which keeps
/// its own). Degenerate triangles stay in (see clean_mesh). Only PLY is read in double precision;
/// the others throw when single precision would move a vertex by more than 5 mm.
/// Throws InputError when the file is missing, cannot be read, or has no faces.
std::vector<MeshPart> load_mesh_parts(const std::filesystem::path& file, UpAxis up = UpAxis::kFile);

/// All parts as one mesh.
TriangleMesh load_mesh(const std::filesystem::path& file, UpAxis up = UpAxis::kFile);

}  // namespace lidarena
