// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "lidarena/map/grid_axes.hpp"
#include "lidarena/map/voxel_key.hpp"

namespace lidarena::map {

/// Indices of the points (m) that are the first of their voxel, in input order, so the result
/// depends only on the input. Points that are not finite are left out.
std::vector<std::uint32_t> first_of_each_voxel(std::span<const Eigen::Vector3f> points,
                                               double voxel_size,
                                               VoxelRounding rounding = VoxelRounding::kFloor);

/// Order of downsampled points: that of the slots in a hash table of their voxels with some slots
/// free. It looks random but depends only on the input.
enum class ThinningOrder {
  kMixed,          ///< by VoxelKeyHash
  kTeschner,       ///< by x 73856093 xor y 19349663 xor z 83492791, as Teschner, Heidelberger,
                   ///< Mueller, Pomerantes, Gross, "Optimized spatial hashing" (VMV 2003)
  kTeschnerPrime,  ///< the same with 19349669, which, unlike 19349663 = 41 * 471943, is a prime
};

constexpr auto enum_names(ThinningOrder) {
  return std::array{std::pair{"mixed", ThinningOrder::kMixed},
                    std::pair{"teschner", ThinningOrder::kTeschner},
                    std::pair{"teschner_prime", ThinningOrder::kTeschnerPrime}};
}

struct Thinning {
  VoxelRounding rounding = VoxelRounding::kFloor;
  ThinningOrder order = ThinningOrder::kMixed;
};

/// The indices of first_of_each_voxel() in the order of `thinning`. In such a pseudo-random order,
/// a second, coarser pass selects points from the whole duration of the scan and not only from its
/// beginning.
std::vector<std::uint32_t> downsampled_indices(std::span<const Eigen::Vector3f> points,
                                               double voxel_size, const Thinning& thinning = {});

/// The points at these indices, with their own coordinates (no centroids).
std::vector<Eigen::Vector3f> thin(std::span<const Eigen::Vector3f> points, double voxel_size,
                                  const Thinning& thinning = {});

/// Mean of the points of each voxel, in the order in which the voxels first occur. Points that are
/// not finite are left out. For estimators only: a mean hides noise.
std::vector<Eigen::Vector3f> voxel_means(std::span<const Eigen::Vector3f> points, double voxel_size,
                                         GridAxes axes = GridAxes::kParallel);

}  // namespace lidarena::map
