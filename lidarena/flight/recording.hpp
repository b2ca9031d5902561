// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "lidarena/base/trajectory.hpp"

namespace lidarena {

/// The poses of a TUM file ("t x y z qx qy qz qw", '#' comments); nanoseconds survive. Throws
/// InputError naming file and line. (lidarena/dataset reads these files too, but flights may not
/// depend on it.)
Trajectory read_recording(const std::filesystem::path& file);

/// Leaves out poses less than `step_s` after the one kept before.
Trajectory thinned(const Trajectory& recording, double step_s);

/// The same motion elsewhere, and of another frame on the same body.
Trajectory placed(const Trajectory& recording, const Pose& world_from_recording,
                  const Pose& recorded_from_body);

}  // namespace lidarena
