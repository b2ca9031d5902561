// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "lidarena/sensor/vibration.hpp"

namespace lidarena::sensor {

/// Movement of a vibrating LiDAR within one scan, cheap enough to evaluate for every shot: the
/// vibration is sampled every 0.25 ms and interpolated by cubics that meet value and slope, with an
/// error of 0.1 % of a sine of 500 Hz. The rotors' thrust is looked up every 5 ms.
class LidarShake {
 public:
  /// From `stamp` until `last_dt_ns` later; `lidar_from_imu` is where the vibration is stated.
  LidarShake(const Vibration& vibration, const flight::Flight& flight, const Pose& lidar_from_imu,
             Time stamp, std::int32_t last_dt_ns);

  /// Pose of the vibrating LiDAR in the frame of the LiDAR at rest, at `dt_ns` after the stamp.
  Pose at(std::int32_t dt_ns) const;

 private:
  Pose lidar_from_imu_, imu_from_lidar_;
  std::vector<Vibration::Shift> nodes_;
};

}  // namespace lidarena::sensor
