// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "lidarena/sensor/sensor_config.hpp"

namespace lidarena::stages {

/// How much of a pattern is written: one of the two, or neither for the default of the format.
struct PatternLength {
  std::uint64_t scans = 0;
  double seconds = 0.0;  ///< the scans that begin before this time
};

/// What was written. `repeats_after`: scans after which the pattern repeats, 0 = never.
struct PatternWritten {
  std::string format;
  std::uint64_t scans = 0;
  std::uint64_t shots = 0;
  std::uint64_t repeats_after = 0;
};

/// Writes the directions and times of a sensor's shots from its start on, without any noise, for
/// other programs. Frame: that of the LiDAR, x forward, z up. The ending of `file` is the format:
///
/// .npy       one float64 array of 8 columns: time (s since the start), x, y, z (unit direction),
///            ring, origin x, y, z (where the shot begins, m)
/// .csv       the same columns; the times are integer nanoseconds
/// .mat3x4f   RobotecGPULidar: per shot a row-major 3 x 4 matrix of float32 whose third column is
///            the direction and whose fourth is the origin. No times
/// .usda      Isaac Sim 5 and later: an OmniLidar prim with one emitter state per scan. No origins
/// .json      Isaac Sim up to 4.5: the same as a profile
///
/// Defaults: all scans until the pattern repeats, of .usda and .json the first scan alone. Throws
/// InputError for any other ending, for both lengths at once, without a length if the pattern takes
/// more than 30 s to repeat, for more than 100 million shots, and for .usda if the scans per second
/// are no whole number.
PatternWritten write_pattern(const sensor::SensorConfig& sensor, const PatternLength& length,
                             const std::filesystem::path& file);

}  // namespace lidarena::stages
