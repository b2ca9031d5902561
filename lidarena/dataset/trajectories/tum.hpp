// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lidarena/base/trajectory.hpp"
#include "lidarena/dataset/part_file.hpp"

namespace lidarena::dataset {

/// Whether a file without rows is an empty trajectory or an error.
enum class EmptyTrajectory { kError, kAllowed };

/// Reads "t x y z qx qy qz qw" rows (seconds, meters), '#' comments. Times are parsed as decimal
/// text, so that nanoseconds are kept; blank lines, tabs, a byte order mark, CRLF and outer blanks
/// are accepted. Quaternions are normalized. Throws InputError naming file and line: not 8 numbers,
/// a value that is not finite, a quaternion norm that differs from 1 by more than 1e-3, a time not
/// later than the previous one, no row at all (unless `empty` allows it, for runs without any
/// pose). Rows that repeat the time of the row before go to `repeated` if it is given.
Trajectory read_tum(const std::filesystem::path& file,
                    EmptyTrajectory empty = EmptyTrajectory::kError,
                    std::vector<StampedPose>* repeated = nullptr);

/// Writes 9 decimals of time and 9 significant digits elsewhere, qw >= 0; `header` lines become
/// comments (they state the frames and the time of the poses). Throws Error when the disk is full.
void write_tum(const std::filesystem::path& file, const Trajectory& trajectory,
               const std::string& header);

/// Writes the same format row by row, without keeping poses in memory.
class TumWriter {
 public:
  /// Throws InputError when the file cannot be created.
  TumWriter(const std::filesystem::path& file, const std::string& header);
  /// Throws InputError (place: the file) when the stamp is not later than the previous one or the
  /// pose is not finite; Error when the disk is full.
  void write(const StampedPose& pose);
  /// Completes the file and renames it from NAME.part.
  void close();

 private:
  std::string place_;
  PartFile out_;
  std::optional<Time> latest_;
};

}  // namespace lidarena::dataset
