// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "lidarena/base/log.hpp"
#include "lidarena/base/trajectory.hpp"
#include "lidarena/dataset/recording.hpp"
#include "lidarena/map/point_map.hpp"

namespace lidarena::live {

/// Topics of a SLAM node; empty: not named.
struct ResultTopics {
  std::string odometry, path, points;

  /// Whether poses or clouds of this topic may be results. Without a name for the poses, those of
  /// all topics of Odometry and Path are, but the truth.
  bool wants(const std::string& topic, const std::string& type) const;
};

/// The results of a SLAM node, collected from its messages. What cannot be read is left out and
/// counted: messages that are cut off, poses that are not finite or whose quaternion has not the
/// norm 1, stamps that do not advance.
class PoseRecord {
 public:
  explicit PoseRecord(ResultTopics topics) : topics_(std::move(topics)) {}

  void add(const dataset::RecordedMessage& message);
  bool empty() const;  ///< no pose so far

  /// Poses of the node, in its world: as known at each scan, and final. The final ones are those of
  /// the last Path, where there is one of that name or no Odometry.
  struct Result {
    Trajectory live, trajectory;
    std::vector<Eigen::Vector3f> map;           ///< first point of each voxel of the clouds, m
    std::string world, body;                    ///< frames; `body` is empty for a Path
    std::map<std::string, std::string> topics;  ///< "odometry", "path", "points": those used
  };
  /// Throws InputError if there are poses of several topics and none is named, Error if there are
  /// none at all.
  Result take(LogSink& log);
  /// Messages by topic that were left out.
  const std::map<std::string, std::uint64_t>& bad() const { return bad_; }

 private:
  static constexpr double kMapVoxel_m = 0.02;  ///< as in the maps of the built-in algorithms

  struct Poses {
    std::string type, world, body;
    std::vector<StampedPose> live;  ///< of each message, the last pose
    std::vector<StampedPose> path;  ///< of a Path: all poses as known last
  };

  void read(const dataset::RecordedMessage& message, const std::string& topic);
  void add_odometry(const dataset::RecordedMessage& message, const std::string& topic);
  void add_path(const dataset::RecordedMessage& message, const std::string& topic);
  void add_cloud(const dataset::RecordedMessage& message, const std::string& topic);
  const Poses* chosen(const std::string& named, std::string_view type, std::string& topic) const;

  ResultTopics topics_;
  std::map<std::string, Poses> poses_;  ///< by topic
  map::PointMap map_{kMapVoxel_m};
  std::string cloud_frame_;
  std::map<std::string, std::uint64_t> bad_;
  std::string first_fault_;
};

}  // namespace lidarena::live
