// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/base/pose.hpp"

namespace lidarena::odometry::arena_lio {

/// The frame in which poses, scans and map are published: the body's frame at the start, leveled by
/// the gravity that the filter estimates, with the heading of the start.
class UprightWorld {
 public:
  /// `start_from_map`: from the map's frame to the body's frame at the start.
  explicit UprightWorld(const Pose& start_from_map) : start_from_map_(start_from_map) {}

  /// Levels the frame anew if it leans by more than `tolerance` (rad) by `gravity` (map frame).
  /// Each time, all that was published before stands in another frame: not for nothing.
  void level(const Eigen::Vector3d& gravity, double tolerance = kTolerance);

  Pose world_from_start() const { return world_from_start_; }
  const Pose& start_from_map() const { return start_from_map_; }
  Pose world_from_map() const { return world_from_start_ * start_from_map_; }

 private:
  static constexpr double kTolerance = 2e-4;  // 0.01 degrees

  Pose start_from_map_;
  Pose world_from_start_ = Pose::Identity();
};

}  // namespace lidarena::odometry::arena_lio
