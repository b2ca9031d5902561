// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <filesystem>
#include <utility>
#include <vector>

#include "lidarena/base/config.hpp"
#include "lidarena/base/log.hpp"
#include "lidarena/world/triangle_mesh.hpp"

namespace lidarena {

/// Which of an SDF model's shapes to take.
enum class ShapeKind { kVisual, kCollision };
template <>
struct EnumNames<ShapeKind> {
  static constexpr std::array names{std::pair{"visual", ShapeKind::kVisual},
                                    std::pair{"collision", ShapeKind::kCollision}};
};

struct SdfOptions {
  ShapeKind shapes = ShapeKind::kVisual;
  /// Further folders that may hold `model://NAME`. Searched after ../models, models, the world
  /// file's own folder and the one above, and before those of GAZEBO_MODEL_PATH.
  std::vector<std::filesystem::path> model_paths;
  /// Warn of models, meshes and shapes that cannot be had, and go on without them.
  bool allow_missing = false;
};

/// All shapes of an SDF world (or of a model.sdf) as one mesh in the world frame, with nested
/// models, relative poses, mesh scales and sub-meshes as Gazebo places them. Mesh files are taken
/// with their coordinates as they stand (a DAE's <up_axis> is ignored, as Gazebo ignores it).
/// Triangles that are degenerate stay in. A <state> saved by Gazebo is not applied, actors and
/// plugins add nothing, and `model://sun`, a lamp, may be missing.
/// Throws InputError, naming the folders searched, for a model or mesh that is not there (unless
/// `allow_missing`), and when nothing with a surface is found or the file is not SDF.
TriangleMesh load_sdf(const std::filesystem::path& file, const SdfOptions& options, LogSink& log);

}  // namespace lidarena
