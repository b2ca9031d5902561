// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "lidarena/base/parallel.hpp"

namespace lidarena::evaluation {

/// The finite points of a map, sorted along a space-filling curve (Morton, 1966): neighbors in the
/// list are neighbors in space, and the points of one cube of a grid are contiguous.
struct MortonOrder {
  static constexpr double kCell_m = 0.05 / 8.0;  ///< cubes of 2^k cells per edge are contiguous
  struct Entry {
    std::uint64_t code = 0;   ///< of the cell; code >> 3 k is that of a cube of 2^k cells per edge
    std::uint32_t index = 0;  ///< into the points
    bool operator<(const Entry& other) const {
      return code != other.code ? code < other.code : index < other.index;
    }
  };
  std::vector<Entry> entries;
};

/// The same for any number of threads. Points beyond 6.5 km share the outermost cells, which only
/// costs time. Up to 2^32 points.
MortonOrder morton_order(std::span<const Eigen::Vector3f> points, const Parallel& parallel);

}  // namespace lidarena::evaluation
