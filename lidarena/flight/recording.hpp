// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "lidarena/base/trajectory.hpp"

namespace lidarena::flight {

/// The poses of a TUM file ("t x y z qx qy qz qw", '#' comments); time stamps are exact to the
/// nanosecond. Throws InputError with file and line. (lidarena/dataset also reads these files, but
/// this module may not depend on it.)
Trajectory read_recording(const std::filesystem::path& file);

/// Drops poses less than `step_s` (s) after the previous kept pose.
Trajectory thinned(const Trajectory& recording, double step_s);

/// The recording transformed to the world frame and to the body frame: world_from_recording * pose
/// * recorded_from_body.
Trajectory placed(const Trajectory& recording, const Pose& world_from_recording,
                  const Pose& recorded_from_body);

}  // namespace lidarena::flight
