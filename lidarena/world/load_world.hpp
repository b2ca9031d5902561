// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "lidarena/base/log.hpp"
#include "lidarena/world/sdf_world.hpp"
#include "lidarena/world/world_model.hpp"

namespace lidarena {

/// What the caller wants otherwise than the world's own file says.
struct WorldOptions {
  std::optional<ShapeKind> shapes;    ///< of an SDF world; visual where nobody says
  std::optional<std::uint64_t> seed;  ///< of a procedural world; 1 where nobody says
  /// Further folders that may hold `model://NAME`; searched after those beside the world file.
  std::vector<std::filesystem::path> model_paths;
  /// Warn of models and meshes of an SDF world that are not there, and go on without them.
  bool allow_missing = false;
};

/// Loads what `file` names, by its ending:
///   .yaml .yml       a file of configs/worlds, see WorldConfig
///   .sdf .world      an SDF world
///   .obj .ply .stl .dae .gltf .glb   a mesh, z up unless its format says otherwise
/// Throws InputError when it is missing, has no faces, or names a model or mesh that is not there.
WorldModel load_world(const std::filesystem::path& file, const WorldOptions& options, LogSink& log);

}  // namespace lidarena
