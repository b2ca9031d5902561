// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>

#include "lidarena/base/parallel.hpp"
#include "lidarena/estimation/elastic_alignment.hpp"
#include "lidarena/map/voxel_hash_map.hpp"
#include "lidarena/odometry/arena_lo/config.hpp"
#include "lidarena/odometry/arena_lo/sampling.hpp"

namespace lidarena::odometry::arena_lo {

struct Registration {
  estimation::ElasticMotion motion;  ///< of the lidar in the map
  int iterations = 0;
  std::size_t keypoints = 0;
  std::size_t matches = 0;     ///< matched keypoints in the last iteration
  double observability = 1.0;  ///< smallest share of a direction; isotropic: 1/3
  bool enough = true;          ///< each iteration had at least min_residuals matches

  double matched_share() const;
};

/// Elastic ICP of `keypoints` against `map` from `guess` (CT-ICP, III-B): alternates neighbor
/// searches and solutions.
Registration register_keypoints(std::span<const TimedPoint> keypoints, const map::VoxelHashMap& map,
                                const estimation::ElasticMotion& guess,
                                const estimation::MotionPrior& prior,
                                const RegistrationConfig& config, int iterations,
                                const Parallel& parallel);

}  // namespace lidarena::odometry::arena_lo
