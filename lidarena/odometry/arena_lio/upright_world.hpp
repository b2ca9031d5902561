// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>

#include "lidarena/base/pose.hpp"
#include "lidarena/estimation/iterated_update.hpp"

namespace lidarena::odometry::arena_lio {

/// The estimate with the LiDAR's pose, and the covariance of that, in place of the IMU's.
estimation::StateEstimate of_lidar(const estimation::StateEstimate& estimate);

/// The frame in which poses, scans and map are published: the body's frame at the start, leveled by
/// the gravity that the filter estimates, with the heading of the start.
class UprightWorld {
 public:
  /// `start_from_map`: from the map's frame to the body's frame at the start.
  explicit UprightWorld(const Pose& start_from_map) : start_from_map_(start_from_map) {}

  /// Levels the frame by `gravity` (map frame), which is known to `sigma` (rad), if that has halved
  /// since the last time: each time, all that was published before stands in another frame, and a
  /// gravity that is not known better is not worth that.
  void level(const Eigen::Vector3d& gravity, double sigma);

  Pose world_from_start() const { return world_from_start_; }
  const Pose& start_from_map() const { return start_from_map_; }
  Pose world_from_map() const { return world_from_start_ * start_from_map_; }

 private:
  Pose start_from_map_;
  Pose world_from_start_ = Pose::Identity();
  double sigma_ = std::numeric_limits<double>::infinity();  ///< rad, of the level
};

}  // namespace lidarena::odometry::arena_lio
