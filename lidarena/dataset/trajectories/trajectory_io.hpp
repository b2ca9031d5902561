// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lidarena/base/trajectory.hpp"

namespace lidarena::dataset {

/// Reads a trajectory in any supported text format, detected by content: comma-separated rows are
/// read by the names in their header (EuRoC ground truth and others, see read_pose_csv()), rows of
/// 12 or 13 numbers are KITTI poses (times from times.txt in the same folder if it exists, else by
/// `rate_hz`), all else is TUM. Throws InputError naming file and line, also where a time repeats.
Trajectory read_trajectory(const std::filesystem::path& file, double rate_hz = 10.0);

/// A trajectory with the names of its frames; empty if its file states none. Recorded truths repeat
/// times in a row (TUM's fr2_desk does): the trajectory has the first of them.
struct FramedTrajectory {
  Trajectory trajectory;
  std::string world;
  std::string body;
  std::vector<StampedPose> repeated = {};  ///< rows whose time repeats that of the row before
  std::string note = {};                   ///< what was assumed about the poses
  std::string ended = {};                  ///< where a recording was cut off or damaged

  /// All rows in the order of the file.
  std::vector<StampedPose> rows() const;
};

/// The same with the names of the frames; also reads the poses on `topic` of a recording,
/// see read_recorded_trajectory(). Of text files, those that Lidarena wrote state their frames, in
/// a comment with a word WORLD_from_BODY ("world_from_body") and one with the columns.
FramedTrajectory read_framed_trajectory(const std::filesystem::path& file,
                                        const std::string& topic = {}, double rate_hz = 10.0);

}  // namespace lidarena::dataset
