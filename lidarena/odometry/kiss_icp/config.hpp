// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/base/rig.hpp"
#include "lidarena/odometry/kiss_icp_steps.hpp"

namespace lidarena::odometry::kiss_icp {

/// v0.2 as shipped, for cars.
Config published(const LidarInfo& lidar);
/// v0.2 as a user would set it for a small sensor in rooms and tunnels.
Config indoor(const LidarInfo& lidar);
/// v0.2 with the best of 32 settings on flights of the development set (docs/results/tuning), for
/// half sweeps.
Config tuned(const LidarInfo& lidar);

}  // namespace lidarena::odometry::kiss_icp
