// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <span>
#include <vector>

namespace lidarena::dataset {

/// A map: points in the world frame (m), optionally with intensity and distance.
struct Cloud {
  std::vector<Eigen::Vector3f> points;
  std::vector<float> intensity;  ///< empty or one per point
  std::vector<float> distance;   ///< empty or one per point: to the mesh, m; NaN if there is none
};

/// Reads .ply (ascii, binary little endian) or .pcd (ascii, binary, binary_compressed). Every point
/// is kept, NaN and infinite ones too: evaluation counts them. Throws InputError.
Cloud read_cloud(const std::filesystem::path& file);
/// Writes binary little-endian PLY: float x y z [intensity] [distance]. Throws Error when the disk
/// is full.
void write_ply(const std::filesystem::path& file, const Cloud& cloud);
/// Writes binary PCD: float x y z [intensity] [distance]. Throws Error when the disk is full.
void write_pcd(const std::filesystem::path& file, const Cloud& cloud);

}  // namespace lidarena::dataset
