// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "lidarena/base/config.hpp"

namespace lidarena::map {

/// Integer cell of a cubic grid, by default floor(coordinate / edge) on each axis.
using Voxel = Eigen::Vector3i;

/// How coordinates are rounded to cells.
enum class VoxelRounding {
  kFloor,     ///< all cells have the same size
  kTruncate,  ///< toward zero: the cells around the planes x = 0, y = 0, z = 0 are twice as wide
};

constexpr auto enum_names(VoxelRounding) {
  return std::array{std::pair{"floor", VoxelRounding::kFloor},
                    std::pair{"truncate", VoxelRounding::kTruncate}};
}

/// A voxel as one integer, 21 bits per axis. The keys of two neighbors differ by a constant.
using VoxelKey = std::uint64_t;

/// Largest index of a cell; points beyond it are assigned to the cell at this index (524 km at 0.5
/// m, 20 km at 2 cm). One cell is left free on each side so that neighbors never wrap around.
inline constexpr int kMaxVoxelIndex = (1 << 20) - 2;

/// Cell of a finite point (m); `inverse_edge` in 1/m.
inline Voxel voxel_of(const Eigen::Vector3f& point, float inverse_edge,
                      VoxelRounding rounding = VoxelRounding::kFloor) {
  const auto index = [&](float coordinate) {
    constexpr auto kLimit = static_cast<float>(kMaxVoxelIndex);
    const float cells = std::clamp(coordinate * inverse_edge, -kLimit, kLimit);
    const int truncated = static_cast<int>(cells);
    const bool below = cells < static_cast<float>(truncated);
    return truncated - (below && rounding == VoxelRounding::kFloor ? 1 : 0);
  };
  return {index(point.x()), index(point.y()), index(point.z())};
}

/// Difference between the keys of two voxels that lie (dx, dy, dz) cells apart.
constexpr VoxelKey voxel_key_step(int dx, int dy, int dz) {
  return static_cast<VoxelKey>(dx) + (static_cast<VoxelKey>(dy) << 21) +
         (static_cast<VoxelKey>(dz) << 42);
}

inline VoxelKey voxel_key(const Voxel& voxel) {
  constexpr VoxelKey kBias = voxel_key_step(1 << 20, 1 << 20, 1 << 20);
  return kBias + voxel_key_step(voxel.x(), voxel.y(), voxel.z());
}

/// Spreads neighboring keys over all bits (Fibonacci hashing, Knuth, TAOCP vol. 3, 6.4).
struct VoxelKeyHash {
  std::size_t operator()(VoxelKey key) const {
    const std::uint64_t product = key * 0x9E3779B97F4A7C15ULL;  // 2^64 / golden ratio
    return static_cast<std::size_t>(product ^ (product >> 32U));
  }
};

}  // namespace lidarena::map
