// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "lidarena/map/grid_axes.hpp"
#include "lidarena/map/voxel_key.hpp"

namespace lidarena::map {

/// Indices of the points (m) that are the first of their voxel, in input order, so the result
/// depends only on the input. Points that are not finite are left out.
std::vector<std::uint32_t> first_of_each_voxel(std::span<const Eigen::Vector3f> points,
                                               double voxel_size,
                                               VoxelRounding rounding = VoxelRounding::kFloor);

/// Mean of the points of each voxel, in the order in which the voxels first occur. Points that are
/// not finite are left out. For estimators only: a mean hides noise.
std::vector<Eigen::Vector3f> voxel_means(std::span<const Eigen::Vector3f> points, double voxel_size,
                                         GridAxes axes = GridAxes::kParallel);

}  // namespace lidarena::map
