// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/trajectories/trajectory_io.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <regex>
#include <sstream>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/dataset.hpp"
#include "lidarena/dataset/text_file.hpp"
#include "lidarena/dataset/trajectories/kitti.hpp"
#include "lidarena/dataset/trajectories/pose_csv.hpp"
#include "lidarena/dataset/trajectories/recorded_trajectory.hpp"
#include "lidarena/dataset/trajectories/tum.hpp"

namespace lidarena::dataset {
namespace {

/// "world" and "body" of the first word WORLD_from_BODY in the comments of a file that Lidarena
/// wrote: these also name the columns. Comments of others are no frames.
void read_frames(const std::filesystem::path& file, FramedTrajectory& into) {
  static const std::regex kFrames("(\\w+)_from_(\\w+)");
  std::istringstream lines(read_bytes(file).substr(0, 4096));
  std::smatch found;
  std::string comments;
  for (std::string line; std::getline(lines, line) && line.starts_with('#');) comments += line;
  if (comments.find("time[s] x y z[m] qx qy qz qw") == std::string::npos) return;
  if (!std::regex_search(comments, found, kFrames)) return;
  into.world = found[1];
  into.body = found[2];
}

/// Throws InputError when most rows have the time of the row before.
void check_times(const std::filesystem::path& file, const FramedTrajectory& read) {
  if (read.repeated.size() <= read.trajectory.size()) return;
  throw InputError(
      file.string(),
      fmt::format("{} of {} rows have the time of the row before ({} s): the times have lost their "
                  "digits or were never set",
                  read.repeated.size(), read.repeated.size() + read.trajectory.size(),
                  format_seconds(read.repeated.front().stamp)),
      "write times with all digits, as 1700000000.123456789");
}

/// With `keep_repeats`, rows that repeat a time are kept apart; else they are errors.
FramedTrajectory read_text(const std::filesystem::path& file, double rate_hz, bool keep_repeats) {
  FramedTrajectory read;
  std::vector<StampedPose>* const repeated = keep_repeats ? &read.repeated : nullptr;
  TextRows rows(file);
  const auto row = rows.next();
  const std::size_t columns = row ? split_words(*row).size() : 0;
  if (row && row->find(',') != std::string_view::npos && split_commas(*row).size() > columns) {
    read.trajectory = read_pose_csv(file, repeated);
  } else if (columns == 12 || columns == 13) {
    const std::filesystem::path times = file.parent_path() / "times.txt";
    if (std::filesystem::exists(times)) {
      read.trajectory = read_kitti_poses(file, read_times(times));
    } else {
      read.trajectory = read_kitti_poses(file, rate_hz);
      read.note =
          fmt::format("{}: its poses have no times; they are taken to come at {} Hz (--rate)",
                      file.string(), rate_hz);
    }
  } else {
    read.trajectory = read_tum(file, EmptyTrajectory::kError, repeated);
  }
  check_times(file, read);
  return read;
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
  if (is_recording(file)) {
    FramedTrajectory read = read_recorded_trajectory(file, topic);
    check_times(file, read);
    return read;
  }
  FramedTrajectory read = read_text(file, rate_hz, true);
  read_frames(file, read);
  return read;
}

Trajectory read_trajectory(const std::filesystem::path& file, double rate_hz) {
  return read_text(file, rate_hz, false).trajectory;
}

}  // namespace lidarena::dataset
