// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/trajectories/trajectory_io.hpp"

#include <algorithm>
#include <iterator>
#include <regex>
#include <sstream>

#include "lidarena/dataset/recording.hpp"
#include "lidarena/dataset/text_file.hpp"
#include "lidarena/dataset/trajectories/kitti.hpp"
#include "lidarena/dataset/trajectories/recorded_trajectory.hpp"
#include "lidarena/dataset/trajectories/tum.hpp"

namespace lidarena::dataset {
namespace {

/// "world" and "body" of the first word WORLD_from_BODY in the comments before the first row.
void read_frames(const std::filesystem::path& file, FramedTrajectory& into) {
  static const std::regex kFrames("(\\w+)_from_(\\w+)");
  std::istringstream lines(read_bytes(file).substr(0, 4096));
  for (std::string line; std::getline(lines, line) && line.starts_with('#');) {
    std::smatch found;
    if (!std::regex_search(line, found, kFrames)) continue;
    into.world = found[1];
    into.body = found[2];
    return;
  }
}

Trajectory read_text(const std::filesystem::path& file, double rate_hz,
                     std::vector<StampedPose>* repeated) {
  TextRows rows(file);
  const auto row = rows.next();
  if (row && row->find(',') != std::string_view::npos) return read_euroc_csv(file, repeated);
  const std::size_t columns = row ? split_words(*row).size() : 0;
  if (columns == 12 || columns == 13) {
    const std::filesystem::path times = file.parent_path() / "times.txt";
    return std::filesystem::exists(times) ? read_kitti_poses(file, read_times(times))
                                          : read_kitti_poses(file, rate_hz);
  }
  return read_tum(file, EmptyTrajectory::kError, repeated);
}

}  // namespace

std::vector<StampedPose> FramedTrajectory::rows() const {
  std::vector<StampedPose> all;
  std::ranges::merge(trajectory.poses(), repeated, std::back_inserter(all), {}, &StampedPose::stamp,
                     &StampedPose::stamp);
  return all;
}

FramedTrajectory read_framed_trajectory(const std::filesystem::path& file, const std::string& topic,
                                        double rate_hz) {
  if (recording_format_of(file)) return read_recorded_trajectory(file, topic);
  FramedTrajectory read;
  read.trajectory = read_text(file, rate_hz, &read.repeated);
  read_frames(file, read);
  return read;
}

Trajectory read_trajectory(const std::filesystem::path& file, double rate_hz) {
  return read_text(file, rate_hz, nullptr);
}

}  // namespace lidarena::dataset
