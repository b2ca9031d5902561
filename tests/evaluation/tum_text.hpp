// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <istream>
#include <sstream>
#include <string>
#include <vector>

#include "lidarena/base/trajectory.hpp"

/// A reader of TUM files that is independent of the library.
namespace lidarena::evaluation::tum_text {

/// "1305031102.160407" to nanoseconds without passing through a double.
inline Time parse_time(const std::string& text) {
  const std::size_t dot = text.find('.');
  std::string digits = text.substr(0, dot);
  std::string decimals = dot == std::string::npos ? "" : text.substr(dot + 1);
  decimals.resize(9, '0');
  return Time{std::stoll(digits + decimals)};
}

inline Trajectory parse(std::istream& in) {
  std::vector<StampedPose> poses;
  std::string line;
  while (std::getline(in, line)) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream row(line);
    std::string stamp;
    Eigen::Vector3d t;
    Eigen::Quaterniond q;
    row >> stamp >> t.x() >> t.y() >> t.z() >> q.x() >> q.y() >> q.z() >> q.w();
    poses.push_back({parse_time(stamp), make_pose(q, t)});
  }
  return Trajectory(std::move(poses));
}
inline Trajectory parse(const std::string& text) {
  std::istringstream in(text);
  return parse(in);
}

/// Path of a file of the tests' data in the repository.
inline std::filesystem::path test_data(const std::string& name) {
  return std::filesystem::path(LIDARENA_SOURCE_DIR) / "tests/data" / name;
}

/// Path of a file of the optional test data, which are not part of the repository.
inline std::filesystem::path shared(const std::string& name) {
  return std::filesystem::path(LIDARENA_SHARED_DATA) / name;
}

}  // namespace lidarena::evaluation::tum_text
