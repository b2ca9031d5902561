// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <span>
#include <vector>

namespace lidarena {

/// A map: points in the world frame (m) and, where known, a value for each.
struct Cloud {
  std::vector<Eigen::Vector3f> points;
  std::vector<float> intensity;  ///< empty or one a point
};

/// Reads .ply (ascii, binary little endian) or .pcd (ascii, binary). Throws InputError.
Cloud read_cloud(const std::filesystem::path& file);
/// Writes binary little-endian PLY: float x y z [intensity]. Throws Error when the disk is full.
void write_ply(const std::filesystem::path& file, const Cloud& cloud);

}  // namespace lidarena
