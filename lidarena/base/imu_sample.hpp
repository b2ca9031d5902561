// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "lidarena/base/time.hpp"

namespace lidarena {

/// One sample of a 6-axis IMU, in the IMU's own frame.
struct ImuSample {
  Time stamp{0};
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();   ///< rad/s
  Eigen::Vector3d accel = Eigen::Vector3d::Zero();  ///< specific force, m/s^2: +9.8 up at rest
};

}  // namespace lidarena
