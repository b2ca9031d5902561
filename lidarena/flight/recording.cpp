// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/recording.hpp"

#include <fmt/format.h>

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
  std::ifstream in(file);
  if (!in)
    throw InputError(file.string(), "cannot be opened", "check the path and the permissions");
  std::vector<StampedPose> poses;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    const std::size_t first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos || line[first] == '#') continue;
    poses.push_back(tum_row(line, fmt::format("{}:{}", file.string(), number)));
  }
  return Trajectory(std::move(poses), file.string());
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
