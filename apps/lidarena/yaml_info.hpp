// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <filesystem>

#include "lidarena/base/config_json.hpp"
#include "lidarena/base/log.hpp"
#include "lidarena/scenes/load_world.hpp"
#include "lidarena/stages/config_folder.hpp"

namespace lidarena {

Json box_json(const Eigen::AlignedBox3d& box);

/// Sizes of a world: of a YAML, SDF or mesh file.
Json world_info(const std::filesystem::path& file, const scenes::WorldOptions& options,
                LogSink& log);

/// What a YAML file describes: a world, flight, sensor, table of beams, study, external program, or
/// settings of an odometry. That follows from its keys: the kind of file that has most of them.
/// Throws InputError if no kind has any of them, or several have equally many, and as the reader of
/// that kind of file does.
Json yaml_info(const std::filesystem::path& file, const stages::ConfigFolder& configs,
               const scenes::WorldOptions& options, LogSink& log);

}  // namespace lidarena
