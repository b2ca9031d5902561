// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace lidarena {

/// Indices of the points (m) that are the first of their voxel, in input order, so the result
/// depends on the input alone. Points that are not finite are left out.
std::vector<std::uint32_t> first_of_each_voxel(std::span<const Eigen::Vector3f> points,
                                               double voxel_size);

/// Those points themselves, with their own coordinates (no centroids), in an order that looks
/// random but depends on the input alone: by hash of the voxel. So a second, coarser pass takes its
/// points from all over the scan's duration and not from its beginning.
std::vector<Eigen::Vector3f> thin(std::span<const Eigen::Vector3f> points, double voxel_size);

/// Mean of the points of each voxel, in the order in which the voxels are first met. Points that
/// are not finite are left out. For estimators alone: a mean hides noise.
std::vector<Eigen::Vector3f> voxel_means(std::span<const Eigen::Vector3f> points,
                                         double voxel_size);

}  // namespace lidarena
