// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "lidarena/base/error.hpp"
#include "lidarena/base/number.hpp"

namespace lidarena::flight {
namespace {

/// Converts decimal seconds to integer nanoseconds without the rounding of large stamps to
/// `double`.
std::optional<Time> exact_seconds(const std::string& text) {
  const std::size_t dot = std::min(text.find('.'), text.size());
  std::int64_t seconds = 0;
  const auto whole = std::from_chars(text.data(), text.data() + dot, seconds);
  if (whole.ec != std::errc{} || whole.ptr != text.data() + dot) return std::nullopt;
  std::string digits = dot < text.size() ? text.substr(dot + 1) : "";
  if (digits.find_first_not_of("0123456789") != std::string::npos) return std::nullopt;
  digits.resize(9, '0');
  const std::int64_t fraction = std::stoll(digits);
  return std::chrono::seconds(seconds) + Time{text.front() == '-' ? -fraction : fraction};
}

/// Calls `row(line, place)` for each line of the file that is not empty and no comment.
template <class Row>
void for_rows(const std::filesystem::path& file, Row&& row) {
  std::ifstream in(file);
  if (!in)
    throw InputError(file.string(), "cannot be opened", "check the path and the permissions");
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    const std::size_t first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos || line[first] == '#') continue;
    row(line, fmt::format("{}:{}", file.string(), number));
  }
}

/// Seconds with a decimal point, or integer nanoseconds.
std::optional<Time> stamp_of(const std::string& text) {
  std::int64_t whole = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), whole);
  constexpr std::int64_t kLeastNanoseconds = 10'000'000'000;  // as seconds: after the year 2286
  if (read.ec == std::errc{} && read.ptr == text.data() + text.size() && whole > kLeastNanoseconds)
    return Time{whole};
  return exact_seconds(text);
}

ImuSample imu_row(std::string line, const std::string& place) {
  std::ranges::replace(line, ',', ' ');
  std::istringstream in(line);
  std::string stamp, rest;
  ImuSample sample;
  in >> stamp >> sample.gyro.x() >> sample.gyro.y() >> sample.gyro.z() >> sample.accel.x() >>
      sample.accel.y() >> sample.accel.z();
  const std::optional<Time> time = stamp_of(stamp);
  if (!in || in >> rest || !time || !sample.gyro.allFinite() || !sample.accel.allFinite())
    throw InputError(place, "is not a row 't gyro x y z accel x y z'",
                     "t in s or ns, rad/s, m/s^2");
  sample.stamp = *time;
  return sample;
}

StampedPose tum_row(const std::string& line, const std::string& place) {
  std::istringstream in(line);
  std::string stamp;
  std::array<double, 7> v{};
  in >> stamp;
  for (double& value : v) in >> value;
  std::string rest;
  if (!in || in >> rest) throw InputError(place, "is not a row 't x y z qx qy qz qw'");
  std::optional<Time> time = exact_seconds(stamp);
  if (!time) {  // a number with an exponent
    const auto seconds = parse_number(stamp);
    if (!seconds) throw InputError(place, "has no time stamp in its first column");
    time = from_seconds(*seconds);
  }
  const Eigen::Quaterniond q(v[6], v[3], v[4], v[5]);
  if (!(std::abs(q.norm() - 1.0) < 1e-2)) {
    throw InputError(place, fmt::format("the quaternion has norm {:g}", q.norm()),
                     "the columns are t x y z qx qy qz qw");
  }
  return {*time, make_pose(q, {v[0], v[1], v[2]})};
}

}  // namespace

Trajectory read_recording(const std::filesystem::path& file) {
  std::vector<StampedPose> poses;
  for_rows(file, [&](const std::string& line, const std::string& place) {
    poses.push_back(tum_row(line, place));
  });
  return Trajectory(std::move(poses), file.string());
}

std::vector<ImuSample> read_imu_recording(const std::filesystem::path& file) {
  std::vector<ImuSample> samples;
  for_rows(file, [&](const std::string& line, const std::string& place) {
    const ImuSample sample = imu_row(line, place);
    if (!samples.empty() && sample.stamp <= samples.back().stamp)
      throw InputError(place, "the stamp is not after the one before it", "sort the rows by time");
    samples.push_back(sample);
  });
  return samples;
}

Trajectory thinned(const Trajectory& recording, double step_s) {
  std::vector<StampedPose> kept;
  for (const StampedPose& pose : recording.poses()) {
    if (kept.empty() || to_seconds(pose.stamp - kept.back().stamp) >= step_s) kept.push_back(pose);
  }
  return Trajectory(std::move(kept));
}

Trajectory placed(const Trajectory& recording, const Pose& world_from_recording,
                  const Pose& recorded_from_body) {
  std::vector<StampedPose> poses(recording.poses().begin(), recording.poses().end());
  for (StampedPose& pose : poses) {
    pose.world_from_body = world_from_recording * pose.world_from_body * recorded_from_body;
  }
  return Trajectory(std::move(poses));
}

}  // namespace lidarena::flight
