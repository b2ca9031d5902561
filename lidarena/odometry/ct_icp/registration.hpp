// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>

#include "lidarena/base/parallel.hpp"
#include "lidarena/estimation/elastic_alignment.hpp"
#include "lidarena/map/voxel_hash_map.hpp"
#include "lidarena/odometry/ct_icp/config.hpp"
#include "lidarena/odometry/ct_icp/sampling.hpp"

namespace lidarena::ct_icp {

struct Registration {
  ElasticMotion motion;  ///< of the lidar in the map
  int iterations = 0;
  std::size_t keypoints = 0;
  std::size_t matches = 0;     ///< keypoints that counted in the last iteration
  double observability = 1.0;  ///< smallest share of the matches' directions, 1/3 if all alike
  bool enough = true;          ///< there were min_residuals in each iteration

  double matched_share() const;
};

/// Elastic ICP of `keypoints` against `map` from `guess` (CT-ICP, III-B): search and solve in turn.
Registration register_keypoints(std::span<const TimedPoint> keypoints, const VoxelHashMap& map,
                                const ElasticMotion& guess, const MotionPrior& prior,
                                const RegistrationConfig& config, int iterations,
                                const Parallel& parallel);

}  // namespace lidarena::ct_icp
