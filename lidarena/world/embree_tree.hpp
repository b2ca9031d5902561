// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "lidarena/world/mesh_tree.hpp"
#include "lidarena/world/triangle_mesh.hpp"

namespace lidarena::world {

/// Embree's tree over a clean mesh. It holds a copy of the mesh in single precision, relative to
/// the center of its bounds. Throws Error (which contains `name`) when Embree fails.
std::unique_ptr<MeshTree> make_embree_tree(const TriangleMesh& mesh, const std::string& name);

}  // namespace lidarena::world
