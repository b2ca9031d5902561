// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "lidarena/base/trajectory.hpp"

namespace lidarena {

/// Reads "t x y z qx qy qz qw" rows (seconds, metres), '#' comments. Times are read as decimal
/// text, so nanoseconds survive. Throws InputError naming file and line.
Trajectory read_tum(const std::filesystem::path& file);

/// Writes 9 decimals of time and 9 significant digits elsewhere; `header` lines become comments
/// (they name the frames and the instant). Throws Error when the disk is full.
void write_tum(const std::filesystem::path& file, const Trajectory& trajectory,
               const std::string& header);

}  // namespace lidarena
