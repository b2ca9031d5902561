// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "lidarena/base/trajectory.hpp"

namespace lidarena {

/// Gathers the poses of a trajectory file; errors name the file's line.
class TrajectoryRows {
 public:
  /// Throws InputError (place `place`) unless `stamp` is later than the one before.
  void add(Time stamp, const Pose& pose, const std::string& place);
  bool empty() const { return poses_.empty(); }
  /// Throws InputError (place `file`) when there is no pose.
  Trajectory finish(const std::string& file);

 private:
  std::vector<StampedPose> poses_;
};

/// Pose of a quaternion as files have it: normalized here when its norm is within 1e-3 of one (six
/// digits leave 1e-6, averaged ones up to 1e-4), else InputError.
Pose pose_from_row(const Eigen::Vector3d& position, const Eigen::Quaterniond& rotation,
                   const std::string& place);

/// Pose of a 3x4 matrix [R t]: R is replaced by the nearest rotation when R R' is within 1e-3 of
/// the identity, else InputError.
Pose pose_from_row(const Eigen::Matrix<double, 3, 4>& matrix, const std::string& place);

}  // namespace lidarena
