// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include "lidarena/base/trajectory.hpp"

namespace lidarena::dataset {

/// Reads times in seconds, one per row (times.txt of KITTI), exact to the nanosecond. Throws
/// InputError naming file and line unless they strictly increase.
std::vector<Time> read_times(const std::filesystem::path& file);

/// Reads KITTI odometry poses: rows of 12 numbers, the 3x4 matrix [R t] row by row (m). Row i has
/// the time `times[i]`; if rows have 13 numbers, the first one is i, counted from zero. Rotations
/// are made orthonormal. Throws InputError naming file and line.
Trajectory read_kitti_poses(const std::filesystem::path& file, const std::vector<Time>& times);
/// The same with frame i at i / rate_hz seconds.
Trajectory read_kitti_poses(const std::filesystem::path& file, double rate_hz = 10.0);

/// Writes such rows of 12 numbers with 9 significant digits; the times are not in the file, see
/// write_times(). Throws Error when the disk is full.
void write_kitti_poses(const std::filesystem::path& file, const Trajectory& trajectory);
/// Writes seconds with 9 decimals, one per row.
void write_times(const std::filesystem::path& file, const std::vector<Time>& times);

}  // namespace lidarena::dataset
