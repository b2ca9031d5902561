// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "lidarena/base/config_json.hpp"
#include "lidarena/base/log.hpp"
#include "lidarena/world/sdf_world.hpp"
#include "lidarena/world/world_model.hpp"

namespace lidarena::scenes {

/// Options that override what the world's file says.
struct WorldOptions {
  std::optional<world::ShapeKind>
      shapes;                         ///< of an SDF world; visual unless the file or this says so
  std::optional<std::uint64_t> seed;  ///< of a procedural world; 1 unless the file or this says so
  /// Additional folders to search for `model://NAME`, after those beside the world file.
  std::vector<std::filesystem::path> model_paths;
  /// "key=value" over what a world file (.yaml) says, and over what its seed draws.
  std::vector<std::string> set{};
  /// Warn about missing models and meshes of an SDF world and load the rest, instead of throwing.
  bool allow_missing = false;
};

/// What a world file (.yaml) says with `set` over it, before its seed draws anything; an empty
/// object for a mesh or an SDF world. Throws InputError for a bad key, or a key of a mesh.
Json world_config(const std::filesystem::path& file, const std::vector<std::string>& set);

/// Loads a world; the file extension selects the format:
///   .yaml .yml       a world file as in configs/worlds, see WorldConfig
///   .sdf .world      an SDF world
///   .obj .ply .stl .dae .gltf .glb   a mesh, z up unless its format specifies otherwise
/// Throws InputError when the file is missing, has no faces, or refers to a model or mesh that does
/// not exist.
world::WorldModel load_world(const std::filesystem::path& file, const WorldOptions& options,
                             LogSink& log);

}  // namespace lidarena::scenes
