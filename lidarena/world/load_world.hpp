// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "lidarena/base/config.hpp"
#include "lidarena/base/log.hpp"
#include "lidarena/world/world_model.hpp"

namespace lidarena {

/// Which of an SDF model's shapes to take.
enum class ShapeKind { kVisual, kCollision };
template <>
struct EnumNames<ShapeKind> {
  static constexpr std::array names{std::pair{"visual", ShapeKind::kVisual},
                                    std::pair{"collision", ShapeKind::kCollision}};
};

struct WorldOptions {
  ShapeKind shapes = ShapeKind::kVisual;
  std::uint64_t seed = 1;  ///< of the procedural worlds
  /// Further folders that may hold `model://NAME`; searched after those beside the world file.
  std::vector<std::filesystem::path> model_paths;
};

/// Loads what `file` names, by its ending:
///   .yaml            a file of configs/worlds (kind: house | cave | mesh | sdf, with parameters)
///   .sdf .world      an SDF world
///   .obj .ply .stl .dae .gltf .glb   a mesh
/// Throws InputError when it is missing, has no faces, or names a model or mesh that is not there.
WorldModel load_world(const std::filesystem::path& file, const WorldOptions& options, LogSink& log);

}  // namespace lidarena
