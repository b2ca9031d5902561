// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "lidarena/world/triangle_mesh.hpp"

namespace lidarena::world {

/// Writes Wavefront OBJ: one object, meters, z up, 9 significant digits, with the normals of
/// the triangles (which the physics of Gazebo needs), without colors.
/// The file appears under its name only once it is complete. Throws Error if it cannot be written.
void save_obj(const std::filesystem::path& file, const TriangleMesh& mesh);

/// Writes a world for Gazebo: `file` (an SDF world with one static model, a sun and gravity) and,
/// beside it, models/NAME with model.config, model.sdf and meshes/NAME.obj, where NAME is the stem
/// of `file`. Gazebo needs that `models` folder in GAZEBO_MODEL_PATH; load_world() does not.
/// Throws InputError when the stem has other characters than letters, digits, '_', '-' and '.', and
/// Error when something cannot be written.
void save_sdf(const std::filesystem::path& file, const TriangleMesh& mesh);

/// Calls save_ply(), save_obj() or save_sdf(), chosen by the file extension (.ply, .obj, .sdf,
/// .world). Throws InputError for other extensions.
void save_world(const std::filesystem::path& file, const TriangleMesh& mesh);

}  // namespace lidarena::world
