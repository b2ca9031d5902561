// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include "lidarena/base/imu_sample.hpp"
#include "lidarena/base/trajectory.hpp"

namespace lidarena::flight {

/// The poses of a TUM file ("t x y z qx qy qz qw", '#' comments); time stamps are exact to the
/// nanosecond. Throws InputError with file and line. (lidarena/dataset also reads these files, but
/// this module may not depend on it.)
Trajectory read_recording(const std::filesystem::path& file);

/// The samples of an IMU: rows "t gyro_x gyro_y gyro_z accel_x accel_y accel_z" with commas or
/// spaces between (rad/s, m/s^2; '#' comments); t in s, or in integer nanoseconds. Stamps strictly
/// increase. Throws InputError with file and line.
std::vector<ImuSample> read_imu_recording(const std::filesystem::path& file);

/// Drops poses less than `step_s` (s) after the previous kept pose.
Trajectory thinned(const Trajectory& recording, double step_s);

/// The recording transformed to the world frame and to the body frame: world_from_recording * pose
/// * recorded_from_body.
Trajectory placed(const Trajectory& recording, const Pose& world_from_recording,
                  const Pose& recorded_from_body);

}  // namespace lidarena::flight
