// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "lidarena/base/trajectory.hpp"
#include "lidarena/dataset/cloud.hpp"
#include "lidarena/dataset/event.hpp"

namespace lidarena {

/// What became of the returns.
struct ReprojectionCounts {
  std::size_t returns = 0;        ///< of the chosen LiDAR
  std::size_t without_pose = 0;   ///< outside the estimate's span or in one of its gaps: dropped
  std::size_t not_finite = 0;     ///< NaN or infinite: dropped
  std::size_t untimed_scans = 0;  ///< scans without per-point times: moved as if taken at once
};

/// Where a point of the map came from.
struct ReturnOrigin {
  std::uint32_t scan = 0;   ///< running number among the scans of the chosen LiDAR
  std::uint32_t point = 0;  ///< index into the scan
};

/// A map made alike for every algorithm: all returns given, each moved with the pose at its own
/// instant (linear position, slerp, never across a gap longer than max_bracket()), of which the
/// first in each voxel stays. Never averaged: centroids hide noise. World frame of the estimate.
/// `origins`, if given, receives one entry a point of the map.
Cloud reproject(EventSource& events, const std::string& lidar_id, const Pose& body_from_lidar,
                const Trajectory& estimate, double voxel_m = 0.02,
                ReprojectionCounts* counts = nullptr, std::vector<ReturnOrigin>* origins = nullptr);

}  // namespace lidarena
