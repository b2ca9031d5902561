// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/base/pose.hpp"
#include "lidarena/odometry/kiss_icp_steps.hpp"

namespace lidarena::odometry::kiss_icp {

/// Sigma (m) of the errors of the constant-velocity prediction so far (paper, eq. 8): scale of the
/// distance between a point and its counterpart before ICP. Within 5 minimum motions of the start,
/// v0.2 counts no error and uses the initial sigma.
class AdaptiveThreshold {
 public:
  explicit AdaptiveThreshold(const Config& config) : config_(config) {}

  double sigma() const;
  /// `prediction` and `estimate` of the same pose, map_from_lidar.
  void observe(const Pose& prediction, const Pose& estimate);

 private:
  Config config_;
  bool counting_ = false;     ///< at the last pose
  double count_ = 0.0;        ///< of errors
  double squared_sum_ = 0.0;  ///< of errors, m^2
};

}  // namespace lidarena::odometry::kiss_icp
