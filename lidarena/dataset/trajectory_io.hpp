// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "lidarena/base/trajectory.hpp"

namespace lidarena {

/// Reads a trajectory of any format we know, told apart by content: comma-separated rows are EuRoC
/// ground truth, rows of 12 or 13 numbers are KITTI poses (times from times.txt beside the file if
/// it is there, else `rate_hz`), all else is TUM. Throws InputError naming file and line.
Trajectory read_trajectory(const std::filesystem::path& file, double rate_hz = 10.0);

/// A trajectory with the frames that its file names; empty where it names none.
struct FramedTrajectory {
  Trajectory trajectory;
  std::string world;
  std::string body;
};

/// The same, and poses of an MCAP file or a bag (see read_recorded_trajectory(), `topic` is for
/// these). A text file names its frames in a comment before the first row, as ours do: the word
/// WORLD_from_BODY ("world_from_body").
FramedTrajectory read_framed_trajectory(const std::filesystem::path& file,
                                        const std::string& topic = {}, double rate_hz = 10.0);

}  // namespace lidarena
