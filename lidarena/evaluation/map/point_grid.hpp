// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <tsl/robin_map.h>

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/map/voxel_key.hpp"

namespace lidarena::evaluation {

/// Points sorted into cubes, for exact nearest-neighbor distances up to a maximum distance. 16
/// bytes per point.
class PointGrid {
 public:
  /// Points that are not finite are left out. `cell`: edge of the cubes, m; `reach`: maximum
  /// distance of nearest(), m; both above 0.
  PointGrid(std::span<const Eigen::Vector3f> points, double cell, double reach,
            const Parallel& parallel);

  /// Distance (m) to the nearest point within the reach, else infinity.
  float nearest(const Eigen::Vector3f& query) const;

 private:
  float cell_, inverse_cell_, reach_;
  std::vector<map::Voxel> steps_;  ///< offsets to all cubes within reach, nearest first
  std::vector<Eigen::Vector3f> points_;
  tsl::robin_map<map::VoxelKey, std::pair<std::uint32_t, std::uint32_t>, map::VoxelKeyHash> cells_;
};

}  // namespace lidarena::evaluation
