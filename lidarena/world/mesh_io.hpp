// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lidarena/base/config.hpp"
#include "lidarena/world/file_material.hpp"
#include "lidarena/world/triangle_mesh.hpp"

namespace lidarena::world {

/// Up axis of a mesh file.
enum class UpAxis {
  kFile,  ///< as specified by the format: glTF is y up, DAE gives it in <up_axis>, others are z up
  kY,     ///< y, regardless of the file; rotated to z up
  kZ,     ///< z, regardless of the file: coordinates are used unchanged, as in Gazebo
};
constexpr auto enum_names(UpAxis) {
  return std::array{std::pair{"file", UpAxis::kFile}, std::pair{"y", UpAxis::kY},
                    std::pair{"z", UpAxis::kZ}};
}

/// One surface of a mesh file, with the names by which an SDF <submesh> may refer to it.
struct MeshPart {
  std::string node;  ///< scene graph node that contains it; empty where the format has none
  std::string name;
  TriangleMesh surface;
};

/// True for the extensions that load_mesh() reads (.obj .ply .stl .dae .gltf .glb, in any case).
bool is_mesh_file(const std::filesystem::path& file);

/// The surfaces of a mesh file in meters, z up: node transforms and DAE units are applied, polygons
/// are split into triangles, points and lines are skipped, equal vertices are merged (except in
/// PLY). Degenerate triangles are kept (see clean_mesh). Only PLY is read in double precision; for
/// the others InputError is thrown when single precision would move a vertex by more than 5 mm.
/// PLY has its materials (see read_ply()), the others have theirs on request. Throws InputError
/// when the file is missing, cannot be read, or has no faces.
std::vector<MeshPart> load_mesh_parts(const std::filesystem::path& file, UpAxis up = UpAxis::kFile,
                                      MaterialSource materials = MaterialSource::kDefault);

/// All parts as one mesh.
TriangleMesh load_mesh(const std::filesystem::path& file, UpAxis up = UpAxis::kFile,
                       MaterialSource materials = MaterialSource::kDefault);

}  // namespace lidarena::world
