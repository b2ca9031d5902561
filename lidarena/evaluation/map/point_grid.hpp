// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <tsl/robin_map.h>
#include <tsl/robin_set.h>

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
  /// Whether there is a point within the reach.
  bool is_near(const Eigen::Vector3f& query) const;

 private:
  /// A cube near the one of the query.
  struct Step {
    map::Voxel offset;
    /// No cube from this one on is nearer to the query (squared, m).
    float min_squared_distance = 0.0F;
  };

  /// Squared distance to the nearest point at a squared distance below `best`, else `best`. Ends at
  /// the first one below `enough`.
  float search(const Eigen::Vector3f& query, float best, float enough) const;

  float cell_, inverse_cell_, beyond_reach_;  ///< the last one squared
  std::vector<Step> steps_;                   ///< to all cubes within reach, nearest first
  Eigen::ArrayX3f points_;                    ///< by axis, so that distances are computed in blocks
  tsl::robin_map<map::VoxelKey, std::pair<std::uint32_t, std::uint32_t>, map::VoxelKeyHash> cells_;
  /// Larger cubes that hold a point or neighbor one that does; in any other, nothing is in reach.
  tsl::robin_set<map::VoxelKey, map::VoxelKeyHash> occupied_;
  float inverse_coarse_;  ///< 1 / edge of the larger cubes, 1/m
};

}  // namespace lidarena::evaluation
