// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "lidarena/base/trajectory.hpp"
#include "lidarena/evaluation/trajectory/association.hpp"

namespace lidarena::evaluation {

/// Interpolated poses of the LiDAR. Keeps the last one, because consecutive points often have the
/// same stamp: the points of a column of a spinning sensor are measured at once.
class LidarPoses {
 public:
  LidarPoses(const Trajectory& trajectory, const Pose& body_from_lidar)
      : trajectory_(trajectory),
        body_from_lidar_(body_from_lidar),
        gap_limit_(gap_limit_of(trajectory)) {}

  /// World from LiDAR at `t`; nullptr outside the trajectory and in its gaps.
  const Pose* at(Time t) {
    if (!known_ || t != stamp_) look_up(t);
    return has_pose_ ? &pose_ : nullptr;
  }

 private:
  void look_up(Time t) {
    known_ = true;
    stamp_ = t;
    const std::optional<Pose> world_from_body = pose_between(trajectory_, t, gap_limit_);
    has_pose_ = world_from_body.has_value();
    if (has_pose_) pose_ = *world_from_body * body_from_lidar_;
  }

  const Trajectory& trajectory_;
  Pose body_from_lidar_;
  Time gap_limit_;
  bool known_ = false;
  Time stamp_{0};
  bool has_pose_ = false;
  Pose pose_ = Pose::Identity();
};

}  // namespace lidarena::evaluation
