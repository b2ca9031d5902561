// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/estimation/iterated_update.hpp"

namespace lidarena::odometry::arena_lio {

/// The estimate with the LiDAR's pose, and the covariance of that, in place of the IMU's.
estimation::StateEstimate of_lidar(const estimation::StateEstimate& estimate);

}  // namespace lidarena::odometry::arena_lio
