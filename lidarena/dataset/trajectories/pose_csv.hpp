// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include "lidarena/base/trajectory.hpp"

namespace lidarena::dataset {

/// Reads comma-separated poses by the names of their columns in the first row (with or without
/// '#'): a time ("timestamp", "time", "t", "%time"), a position ("x", "p_RS_R_x", "tx",
/// "...position.x", ...) and a quaternion ("qx", "q_RS_w", "...orientation.w", ...), in any order;
/// columns of velocities, biases and covariances are ignored. The unit of the time is the one in
/// the name ("[ns]"; that of EuRoC is ns), else it is told by the magnitude: seconds below 1e11,
/// then ms, us, ns. Rows that repeat the time of the row before go to `repeated` if it is given.
/// Throws InputError naming file, line and column when a column is missing or named twice, or a row
/// is broken.
Trajectory read_pose_csv(const std::filesystem::path& file,
                         std::vector<StampedPose>* repeated = nullptr);

}  // namespace lidarena::dataset
