// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "lidarena/dataset/dataset.hpp"

namespace lidarena {

/// Rig of foreign data with one LiDAR, named "lidar", mounted as `options.body_from_lidar` says, or
/// else in the body frame. Throws InputError (place `path`) when options.sensor names another one.
Rig single_lidar_rig(const std::filesystem::path& path, const ReadOptions& options);

/// Leaves the LiDAR `options.sensor` alone in the rig (empty = all) and mounts it as
/// `options.body_from_lidar` says. Throws InputError (place `place`) when there is none such, or
/// when several are left to be mounted.
void choose_lidar(const ReadOptions& options, const std::string& place, Rig& rig);

}  // namespace lidarena
