// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "lidarena/dataset/dataset.hpp"

namespace lidarena::dataset {

/// The id of a sensor by its topic: "/os/points" becomes "os", "/livox/lidar" becomes
/// "livox_lidar".
std::string id_of_topic(std::string topic);

/// Rig of third-party data with one LiDAR, named "lidar", mounted at `options.body_from_lidar`
/// (identity if empty). Throws InputError (place `path`) when options.sensor
/// names another one.
Rig single_lidar_rig(const std::filesystem::path& path, const ReadOptions& options);

/// Keeps only the LiDAR `options.sensor` (its id or topic) in the rig (empty = all) and mounts it
/// at `options.body_from_lidar`, if given. Throws InputError (place `place`) when there is no such
/// LiDAR, or when body_from_lidar is given and several LiDARs are left.
void choose_lidar(const ReadOptions& options, const std::string& place, Rig& rig);

}  // namespace lidarena::dataset
