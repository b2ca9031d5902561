// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "lidarena/estimation/imu_buffer.hpp"
#include "lidarena/estimation/imu_track.hpp"
#include "lidarena/estimation/preintegration.hpp"

namespace lidarena::estimation {

/// What an estimator knows of its IMU.
struct ImuModel {
  ImuNoise noise;
  double accel_scale = 1.0;                     ///< factor from its accelerations to m/s^2
  Eigen::Vector3d gravity{0.0, 0.0, -9.80665};  ///< m/s^2, world
};

/// Adds the intervals to `sum`, which began in `state`, and returns the motion through them. Gaps
/// are coasted with constant velocity and large noise.
ImuTrack integrate(const std::vector<ImuInterval>& intervals, const NavState& state,
                   const ImuModel& imu, Preintegration& sum);

}  // namespace lidarena::estimation
