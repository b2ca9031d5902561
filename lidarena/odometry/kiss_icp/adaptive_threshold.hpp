// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/base/pose.hpp"
#include "lidarena/odometry/kiss_icp/config.hpp"

namespace lidarena::odometry::kiss_icp {

/// Upper limit (m) on how far a prediction `error` (true pose relative to the predicted one) moves
/// a point at `range` m: |t| + 2 range sin(angle / 2) (paper, eq. 5 and 6).
double displacement(const Pose& error, double range);

/// Sigma (m) of the errors of the constant-velocity prediction so far (paper, eq. 8): scale of the
/// distance between a point and its counterpart before ICP.
class AdaptiveThreshold {
 public:
  explicit AdaptiveThreshold(const Config& config);

  double sigma() const;
  /// `prediction` and `estimate` of the same pose, map_from_lidar.
  void observe(const Pose& prediction, const Pose& estimate);

 private:
  Config config_;
  bool counting_;       ///< at the last pose
  double count_;        ///< of errors
  double squared_sum_;  ///< of errors, m^2
};

}  // namespace lidarena::odometry::kiss_icp
