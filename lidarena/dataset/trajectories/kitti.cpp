// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/trajectories/kitti.hpp"

#include <fmt/format.h>

#include <charconv>
#include <functional>
#include <iterator>
#include <optional>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/part_file.hpp"
#include "lidarena/dataset/text_file.hpp"
#include "lidarena/dataset/trajectories/trajectory_rows.hpp"

namespace lidarena::dataset {
namespace {

constexpr std::int64_t kMaxFrame = 10'000'000;

std::optional<std::int64_t> parse_integer(std::string_view word) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

std::int64_t frame_number(std::string_view word, const std::string& place) {
  const auto frame = parse_integer(word);
  if (!frame || *frame < 0 || *frame > kMaxFrame) {
    throw InputError(place, fmt::format("'{}' is not a frame number", word),
                     "the first of 13 columns is the frame number, counted from zero");
  }
  return *frame;
}

using TimeOfFrame = std::function<Time(std::int64_t frame, const std::string& place)>;

Trajectory read_kitti_rows(const std::filesystem::path& file, const TimeOfFrame& time_of_frame) {
  TextRows rows(file);
  TrajectoryRows poses;
  for (std::int64_t index = 0; const auto row = rows.next(); ++index) {
    const auto words = split_words(*row);
    const std::string place = rows.place();
    if (words.size() != 12 && words.size() != 13) {
      throw InputError(place, fmt::format("holds {} columns, not 12", words.size()),
                       "rows are r11 r12 r13 tx r21 r22 r23 ty r31 r32 r33 tz, "
                       "optionally preceded by the frame number");
    }
    const std::size_t skip = words.size() - 12;
    Eigen::Matrix<double, 3, 4> matrix;
    for (int i = 0; i < 12; ++i) {
      matrix(i / 4, i % 4) = finite_number(words[skip + static_cast<std::size_t>(i)], place);
    }
    const std::int64_t frame = skip == 1 ? frame_number(words[0], place) : index;
    poses.add(time_of_frame(frame, place), pose_from_row(matrix, place), place);
  }
  return poses.finish(file.string());
}

}  // namespace

std::vector<Time> read_times(const std::filesystem::path& file) {
  TextRows rows(file);
  std::vector<Time> times;
  while (const auto row = rows.next()) {
    const Time time = seconds_at(*row, rows.place());
    if (!times.empty() && time <= times.back()) {
      throw InputError(rows.place(), "the time is not later than the previous one",
                       "times.txt must hold one time per sweep, strictly increasing");
    }
    times.push_back(time);
  }
  return times;
}

Trajectory read_kitti_poses(const std::filesystem::path& file, const std::vector<Time>& times) {
  return read_kitti_rows(file, [&](std::int64_t frame, const std::string& place) {
    if (static_cast<std::size_t>(frame) >= times.size()) {
      throw InputError(
          place, fmt::format("frame {} has no time, only {} times are given", frame, times.size()),
          "give the times of the same sequence");
    }
    return times[static_cast<std::size_t>(frame)];
  });
}

Trajectory read_kitti_poses(const std::filesystem::path& file, double rate_hz) {
  if (!(rate_hz >= 0.01 && rate_hz <= 1e6)) {
    throw InputError(file.string(), fmt::format("{} Hz is not a valid frame rate", rate_hz));
  }
  return read_kitti_rows(file, [&](std::int64_t frame, const std::string&) {
    return from_seconds(static_cast<double>(frame) / rate_hz);
  });
}

void write_kitti_poses(const std::filesystem::path& file, const Trajectory& trajectory) {
  std::string text;
  for (const StampedPose& pose : trajectory.poses()) {
    for (int i = 0; i < 12; ++i) {
      const double value = pose.world_from_body.matrix()(i / 4, i % 4) + 0.0;  // no "-0"
      fmt::format_to(std::back_inserter(text), "{}{:.9g}", i == 0 ? "" : " ", value);
    }
    text += '\n';
  }
  write_text_file(file, text);
}

void write_times(const std::filesystem::path& file, const std::vector<Time>& times) {
  std::string text;
  for (const Time time : times) text += format_seconds(time) + "\n";
  write_text_file(file, text);
}

}  // namespace lidarena::dataset
