// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "lidarena/dataset/dataset.hpp"

namespace lidarena {

/// Rig of foreign data with one LiDAR, named "lidar", mounted as `options.body_from_lidar` says, or
/// else as the data do. Throws InputError (place `path`) when options.sensor names another one.
Rig single_lidar_rig(const std::filesystem::path& path, const ReadOptions& options,
                     const Pose& body_from_lidar);

}  // namespace lidarena
