// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "lidarena/base/trajectory.hpp"
#include "lidarena/odometry/odometry.hpp"

namespace lidarena::stages {

/// Collects what a method says of the body's motion within its scans, relative to each scan's
/// estimate, so that it can be joined to the estimates as they stand at the end. Poses of a scan
/// are kept at least 5 ms apart; 32 bytes each.
class MotionRecord {
 public:
  /// `result`: of the next scan. A scan without motion is at its estimate's pose and instant. What
  /// it revises replaces the motion of the scan before.
  void add(const odometry::ScanResult& result);
  /// The poses along `trajectory`: each scan's motion from the pose that the trajectory has at the
  /// scan's instant (scans outside it are left out), without those that are not later than the pose
  /// before them. Empty if no scan had a motion.
  Trajectory along(const Trajectory& trajectory) const;

 private:
  void add(const StampedPose& estimate, std::span<const StampedPose> motion);

  struct Step {
    std::int32_t dt_ns = 0;  ///< since the estimate's instant
    Eigen::Vector3f translation = Eigen::Vector3f::Zero();
    Eigen::Quaternionf rotation = Eigen::Quaternionf::Identity();  ///< estimate from this pose
  };
  struct ScanMotion {
    Time stamp{0};  ///< instant of the estimate
    std::size_t end = 0;
  };

  std::vector<Step> steps_;
  std::vector<ScanMotion> scans_;  ///< each has the steps from the end of the one before
  bool any_ = false;
};

}  // namespace lidarena::stages
