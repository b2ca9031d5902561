// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "lidarena/base/trajectory.hpp"

namespace lidarena {

/// Reads a trajectory of any format we know, told apart by content: comma-separated rows are EuRoC
/// ground truth, rows of 12 or 13 numbers are KITTI poses (times from times.txt beside the file if
/// it is there, else `rate_hz`), all else is TUM. Throws InputError naming file and line.
Trajectory read_trajectory(const std::filesystem::path& file, double rate_hz = 10.0);

}  // namespace lidarena
