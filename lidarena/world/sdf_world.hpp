// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <filesystem>
#include <utility>
#include <vector>

#include "lidarena/base/config.hpp"
#include "lidarena/base/log.hpp"
#include "lidarena/world/file_material.hpp"
#include "lidarena/world/triangle_mesh.hpp"

namespace lidarena::world {

/// Which shapes of an SDF model to load.
enum class ShapeKind { kVisual, kCollision };
constexpr auto enum_names(ShapeKind) {
  return std::array{std::pair{"visual", ShapeKind::kVisual},
                    std::pair{"collision", ShapeKind::kCollision}};
}

struct SdfOptions {
  ShapeKind shapes = ShapeKind::kVisual;
  /// Additional folders to search for `model://NAME`: after ../models, models, the world file's own
  /// folder and the one above, and before those of GAZEBO_MODEL_PATH.
  std::vector<std::filesystem::path> model_paths;
  /// Warn about missing models and meshes and unsupported shapes and load the rest, instead of
  /// throwing.
  bool allow_missing = false;
  /// Of mesh files, and of shapes with a <laser_retro>, which has precedence.
  MaterialSource materials = MaterialSource::kDefault;
};

/// All shapes of an SDF world (or of a model.sdf) as one mesh in the world frame, with nested
/// models, relative poses, mesh scales and sub-meshes as Gazebo places them. The coordinates of
/// mesh files are used unchanged (a DAE's <up_axis> is ignored, as in Gazebo). Degenerate triangles
/// are kept. A <state> saved by Gazebo is not applied, actors and plugins are ignored. Where there
/// is no local copy of Gazebo's models sun and ground_plane, whatever the host in their URI, the
/// sun is left out (a light casts nothing) and the plane is put where it is included (100 m x 100
/// m). Throws InputError, with a list of the folders searched, for a missing model or mesh (unless
/// `allow_missing`), and when nothing with a surface is found or the file is not SDF.
TriangleMesh load_sdf(const std::filesystem::path& file, const SdfOptions& options, LogSink& log);

}  // namespace lidarena::world
