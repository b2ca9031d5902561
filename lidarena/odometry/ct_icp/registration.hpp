// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>

#include "lidarena/base/parallel.hpp"
#include "lidarena/map/neighborhood.hpp"
#include "lidarena/map/voxel_hash_map.hpp"
#include "lidarena/odometry/ct_icp/prediction.hpp"
#include "lidarena/odometry/ct_icp/sampling.hpp"

namespace lidarena::odometry::ct_icp {

struct Registration {
  ElasticMotion motion;  ///< of the lidar in the map
  int iterations = 0;
  std::size_t matches = 0;     ///< matched keypoints in the last iteration
  double observability = 1.0;  ///< see observability_of
  bool failed = false;         ///< an iteration had fewer than min_neighbors matches
};

/// Match of a keypoint, at `position` (m, map) with the present motion, with the plane of the
/// neighbors through the farthest of them. Weight, with c1 + c2 = 1:
/// c1 planarity^2 + c2 exp(-distance of that neighbor / (max_plane_distance_m min_neighbors)).
ElasticMatch plane_match(const TimedPoint& keypoint, const Eigen::Vector3d& position,
                         std::span<const map::Neighbor> neighbors,
                         const RegistrationConfig& config);

/// Elastic ICP of `keypoints` against `map` (CT-ICP, III-B): alternates neighbor searches and
/// solutions.
Registration register_keypoints(std::span<const TimedPoint> keypoints, const map::VoxelHashMap& map,
                                const Expectation& expected, const RegistrationConfig& config,
                                const Parallel& parallel);

}  // namespace lidarena::odometry::ct_icp
