// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lidarena/base/trajectory.hpp"

namespace lidarena::dataset {

/// Reads a trajectory in any supported text format, detected by content: comma-separated rows are
/// EuRoC ground truth, rows of 12 or 13 numbers are KITTI poses (times from times.txt in the same
/// folder if it exists, else by `rate_hz`), all else is TUM. Throws InputError naming file and
/// line.
Trajectory read_trajectory(const std::filesystem::path& file, double rate_hz = 10.0);

/// A trajectory with the names of its frames; empty if its file states none. Recorded truths repeat
/// times in a row (TUM's fr2_desk does): the trajectory has the first of them.
struct FramedTrajectory {
  Trajectory trajectory;
  std::string world;
  std::string body;
  std::vector<StampedPose> repeated = {};  ///< rows whose time repeats that of the row before

  /// All rows in the order of the file.
  std::vector<StampedPose> rows() const;
};

/// The same with the names of the frames; also reads the poses on `topic` of an MCAP file or a bag,
/// see read_recorded_trajectory(). A text file states its frames in a comment before the first row,
/// as a word WORLD_from_BODY (Lidarena writes "world_from_body").
FramedTrajectory read_framed_trajectory(const std::filesystem::path& file,
                                        const std::string& topic = {}, double rate_hz = 10.0);

}  // namespace lidarena::dataset
