// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "lidarena/base/trajectory.hpp"

namespace lidarena::dataset {

/// Collects the poses of a trajectory file; errors name the line of the file.
class TrajectoryRows {
 public:
  /// Rows whose time repeats that of the row before are collected in `repeated` instead (motion
  /// capture writes such rows); if it is null, they are errors.
  explicit TrajectoryRows(std::vector<StampedPose>* repeated = nullptr) : repeated_(repeated) {}
  /// Throws InputError (place `place`) if `stamp` is earlier than the previous one, or equal where
  /// that is an error.
  void add(Time stamp, const Pose& pose, const std::string& place);
  bool empty() const { return poses_.empty(); }
  /// Throws InputError (place `file`) when there is no pose.
  Trajectory finish(const std::string& file);

 private:
  std::vector<StampedPose> poses_;
  std::vector<StampedPose>* repeated_;
};

/// Pose from a quaternion as read from a file, which is normalized here; throws InputError unless
/// its norm is within 1e-3 of one (rounding to six digits causes 1e-6, averaging up to 1e-4).
Pose pose_from_row(const Eigen::Vector3d& position, const Eigen::Quaterniond& rotation,
                   const std::string& place);

/// Pose from a 3x4 matrix [R t]: R is replaced by the nearest rotation; throws InputError unless R
/// R' is within 1e-3 of the identity.
Pose pose_from_row(const Eigen::Matrix<double, 3, 4>& matrix, const std::string& place);

}  // namespace lidarena::dataset
