// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lidarena/map/voxel_key.hpp"

/// The order in which a hash table holds its items. Pseudo-random, but the same each time.
namespace lidarena::map {

/// Hash of a voxel: Teschner, Heidelberger, Mueller, Pomerantes, Gross, "Optimized spatial hashing"
/// (VMV 2003). Its authors' `y_factor` is 19349663.
inline std::uint32_t spatial_hash(const Voxel& voxel, std::uint32_t y_factor) {
  const Eigen::Array<std::uint32_t, 3, 1> v = voxel.cast<std::uint32_t>();
  return v.x() * 73856093U ^ v.y() * y_factor ^ v.z() * 83492791U;
}

/// Indices of `hashes` in the order of the slots of a table into which they are inserted one after
/// the other, each from the slot of its hash modulo `slots` on: Robin Hood hashing (Celis, Larson,
/// Munro, FOCS 1985). `slots`: a power of two, more than there are hashes.
std::vector<std::uint32_t> robin_hood_order(std::span<const std::uint32_t> hashes,
                                            std::size_t slots);

}  // namespace lidarena::map
