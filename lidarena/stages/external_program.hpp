// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <utility>

#include "lidarena/base/config.hpp"
#include "lidarena/dataset/dataset.hpp"

namespace lidarena::stages {

/// The frame whose poses a program gives.
enum class PoseOf { kBody, kLidar, kImu };
constexpr auto enum_names(PoseOf) {
  return std::array{std::pair{"body", PoseOf::kBody}, std::pair{"lidar", PoseOf::kLidar},
                    std::pair{"imu", PoseOf::kImu}};
}

/// The instant of a pose that has the stamp of a scan.
enum class PoseAt {
  kStamp,   ///< that stamp, the scan's first firing
  kMiddle,  ///< halfway to the scan's last point
  kEnd,     ///< the scan's last point
};
constexpr auto enum_names(PoseAt) {
  return std::array{std::pair{"stamp", PoseAt::kStamp}, std::pair{"middle", PoseAt::kMiddle},
                    std::pair{"end", PoseAt::kEnd}};
}

/// How a program that is a ROS 2 node is fed, and where its results are read: live topics. A node
/// has `odometry` or `path`, or both: then its live poses come from the first and its final ones
/// from the second. See docs/ros2.md.
struct NodeTopics {
  std::string odometry, path, points;
  double rate = 0.0;
  double answer_limit_s = 5.0;
  double start_limit_s = 60.0;

  bool is_used() const { return !odometry.empty() || !path.empty(); }
  /// The topic whose messages answer scans.
  const std::string& answer() const { return odometry.empty() ? path : odometry; }

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("odometry", self.odometry, "", "topic of nav_msgs/msg/Odometry with a pose for each scan");
    v("path", self.path, "", "topic of nav_msgs/msg/Path, whose last message is the final one");
    v("points", self.points, "", "topic of the registered clouds, in the frame of the poses");
    v("rate", self.rate, "",
      "speed, times that of the sensor; 0 = each scan after the answer "
      "to the one before",
      at_least(0));
    v("answer_limit_s", self.answer_limit_s, "s", "how long an answer is waited for", above(0));
    v("start_limit_s", self.start_limit_s, "s", "how long the node's topics are waited for",
      above(0));
  }
};

/// A SLAM program that is not part of lidarena, run by a command line. See docs/external_slam.md.
struct ExternalProgram {
  std::string name;
  std::string command;
  dataset::DatasetFormat input = dataset::DatasetFormat::kMcap;
  dataset::Dialect dialect = dataset::Dialect::kSi;
  PoseOf pose_of = PoseOf::kLidar;
  PoseAt pose_at = PoseAt::kStamp;
  double start_s = 0.0;
  NodeTopics node{};
  std::string needs{};    ///< command line that succeeds where the program is installed
  std::string install{};  ///< how to install it

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("name", self.name, "", "name in the tables");
    v("command", self.command, "",
      "command line, with {input}, {output}, {sensor}, {threads}, {rig}; in a file also {here}");
    v("input", self.input, "", "format in which it gets the dataset");
    v("dialect", self.dialect, "", "units and layouts: SI or those of the sensors' drivers");
    v("pose_of", self.pose_of, "", "frame of its poses: of the body, the LiDAR or the IMU");
    v("pose_at", self.pose_at, "",
      "instant of a pose that has a scan's stamp: the stamp, or the middle or end of the scan");
    v("start_s", self.start_s, "s",
      "stamp of the recording's start; some programs misread stamps near 0", at_least(0));
    v("node", self.node, "", "topics of a ROS 2 node; none = a program that reads files");
    v("needs", self.needs, "", "command line that succeeds where the program is installed");
    v("install", self.install, "", "how to install it");
  }
};

}  // namespace lidarena::stages
