// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "lidarena/base/trajectory.hpp"
#include "lidarena/dataset/run_files.hpp"
#include "lidarena/evaluation/trajectory/association.hpp"

namespace lidarena::evaluation {

/// Poses of a body between which it is interpolated (linear position, slerp), never across a gap
/// longer than `gap_limit`. The poses must outlive it.
struct BodyMotion {
  const Trajectory& poses;
  Time gap_limit;

  /// One pose per scan: its own period tells what a gap is.
  BodyMotion(const Trajectory& trajectory)
      : poses(trajectory), gap_limit(gap_limit_of(trajectory)) {}
  /// What the method says of the motion within its scans, else its trajectory. Gaps are those of
  /// the trajectory, because poses within a scan are closer together than scans.
  explicit BodyMotion(const dataset::RunFiles& run)
      : poses(run.motion.empty() ? run.trajectory : run.motion),
        gap_limit(gap_limit_of(run.trajectory)) {}
};

/// Interpolated poses of the LiDAR. Keeps the last one, because consecutive points often have the
/// same stamp: the points of a column of a spinning sensor are measured at once.
class LidarPoses {
 public:
  LidarPoses(const BodyMotion& motion, const Pose& body_from_lidar)
      : motion_(motion), body_from_lidar_(body_from_lidar) {}

  /// World from LiDAR at `t`; nullptr outside the motion's span and in its gaps.
  const Pose* at(Time t) {
    if (!known_ || t != stamp_) look_up(t);
    return has_pose_ ? &pose_ : nullptr;
  }

 private:
  void look_up(Time t) {
    known_ = true;
    stamp_ = t;
    const std::optional<Pose> world_from_body = pose_between(motion_.poses, t, motion_.gap_limit);
    has_pose_ = world_from_body.has_value();
    if (has_pose_) pose_ = *world_from_body * body_from_lidar_;
  }

  BodyMotion motion_;
  Pose body_from_lidar_;
  bool known_ = false;
  Time stamp_{0};
  bool has_pose_ = false;
  Pose pose_ = Pose::Identity();
};

}  // namespace lidarena::evaluation
