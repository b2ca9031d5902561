// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "lidarena/base/trajectory.hpp"
#include "lidarena/dataset/part_file.hpp"

namespace lidarena {

/// Whether a file without a row is an empty trajectory or an error.
enum class EmptyTrajectory { kError, kAllowed };

/// Reads "t x y z qx qy qz qw" rows (seconds, meters), '#' comments. Times are read as decimal
/// text, so nanoseconds survive; blank lines, tabs, a byte order mark, CRLF and blanks at the ends
/// do no harm. Quaternions are normalized. Throws InputError naming file and line: not 8 numbers,
/// a value that is not finite, a norm off 1 by more than 1e-3, a time not later than the one
/// before, no row at all (unless `empty` allows it: a run that never gave a pose).
Trajectory read_tum(const std::filesystem::path& file,
                    EmptyTrajectory empty = EmptyTrajectory::kError);

/// Writes 9 decimals of time and 9 significant digits elsewhere, qw >= 0; `header` lines become
/// comments (they name the frames and the instant). Throws Error when the disk is full.
void write_tum(const std::filesystem::path& file, const Trajectory& trajectory,
               const std::string& header);

/// Writes the same file row by row, as the poses come: nothing of it stays in memory.
class TumWriter {
 public:
  /// Throws InputError when the file cannot be created.
  TumWriter(const std::filesystem::path& file, const std::string& header);
  /// Throws InputError (place: the file) when the stamp is not later than the one before or the
  /// pose is not finite; Error when the disk is full.
  void write(const StampedPose& pose);
  /// Gives the file its name.
  void close();

 private:
  std::string place_;
  PartFile out_;
  std::optional<Time> latest_;
};

}  // namespace lidarena
