// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <span>
#include <vector>

namespace lidarena::dataset {

/// A map: points in the world frame (m) from `origin` on, optionally with intensity and distance.
struct Cloud {
  std::vector<Eigen::Vector3f> points;
  std::vector<float> intensity;  ///< empty or one per point
  std::vector<float> distance;   ///< empty or one per point: to the mesh, m; NaN if there is none
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< world coordinates of (0, 0, 0) of `points`
};

/// Reads .ply (ascii, binary little endian) or .pcd (ascii, binary, binary_compressed). Every point
/// is kept, NaN and infinite ones too: evaluation counts them. Throws InputError.
///
/// Map coordinates (UTM) are beyond 10 km, where float rounds to millimeters and more. With
/// `keep_origin`, such points are read relative to the first of them, which becomes Cloud::origin.
Cloud read_cloud(const std::filesystem::path& file, bool keep_origin = false);
/// Writes binary little-endian PLY, double x y z where `origin` is not zero, else float x y z
/// [intensity] [distance]. Throws Error when the disk is full.
void write_ply(const std::filesystem::path& file, const Cloud& cloud);
/// Writes binary PCD: float x y z [intensity] [distance]. Throws Error when the disk is full.
void write_pcd(const std::filesystem::path& file, const Cloud& cloud);

}  // namespace lidarena::dataset
