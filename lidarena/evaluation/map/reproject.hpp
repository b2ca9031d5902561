// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "lidarena/base/event.hpp"
#include "lidarena/dataset/points/cloud.hpp"
#include "lidarena/evaluation/map/lidar_poses.hpp"

namespace lidarena::evaluation {

/// Numbers of processed and dropped returns.
struct ReprojectionCounts {
  std::size_t returns = 0;        ///< of the chosen LiDAR
  std::size_t without_pose = 0;   ///< outside the motion's span or in one of its gaps: dropped
  std::size_t not_finite = 0;     ///< NaN or infinite: dropped
  std::size_t untimed_scans = 0;  ///< scans without per-point times: moved as if measured at once
};

/// A map built in the same way for every algorithm: each return is moved with the pose at its own
/// instant, and the first return in each voxel is kept. Never averaged, because centroids hide
/// noise. In the world frame of the estimate, with intensity and origin of each point. `take` gets
/// the points that each scan adds.
ReprojectionCounts reproject(EventSource& events, const std::string& lidar_id,
                             const Pose& body_from_lidar, const BodyMotion& motion,
                             const std::function<void(const dataset::Cloud&)>& take,
                             double voxel_size_m = 0.02);

/// The same as one cloud.
dataset::Cloud reprojected(EventSource& events, const std::string& lidar_id,
                           const Pose& body_from_lidar, const BodyMotion& motion,
                           ReprojectionCounts* counts = nullptr);

}  // namespace lidarena::evaluation
