// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "lidarena/dataset/event.hpp"
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

/// The return from which a point of the map was made.
struct ReturnOrigin {
  std::uint32_t scan = 0;   ///< index among the scans of the chosen LiDAR
  std::uint32_t point = 0;  ///< index into the scan
};

/// A map built in the same way for every algorithm: each return is moved with the pose at its own
/// instant, and the first return in each voxel is kept. Never averaged, because centroids hide
/// noise. In the world frame of the estimate. `origins`, if given, receives one entry per point of
/// the map.
dataset::Cloud reproject(dataset::EventSource& events, const std::string& lidar_id,
                         const Pose& body_from_lidar, const BodyMotion& motion,
                         double voxel_size_m = 0.02, ReprojectionCounts* counts = nullptr,
                         std::vector<ReturnOrigin>* origins = nullptr);

}  // namespace lidarena::evaluation
