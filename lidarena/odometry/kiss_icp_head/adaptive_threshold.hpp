// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "lidarena/odometry/kiss_icp_steps.hpp"

namespace lidarena::odometry::kiss_icp_head {

/// Sigma (m) of the errors of the constant-velocity prediction so far (paper, eq. 8): scale of the
/// distance between a point and its counterpart before ICP. The initial sigma counts as one error.
class AdaptiveThreshold {
 public:
  explicit AdaptiveThreshold(const kiss_icp::Config& config)
      : config_(config), squared_sum_(config.initial_threshold_m * config.initial_threshold_m) {}

  double sigma() const { return std::sqrt(squared_sum_ / count_); }
  /// `prediction` and `estimate` of the same pose, map_from_lidar.
  void observe(const Pose& prediction, const Pose& estimate) {
    const double deviation =
        kiss_icp::displacement(prediction.inverse() * estimate, config_.max_range_m);
    if (!(deviation > config_.min_motion_m)) return;
    squared_sum_ += deviation * deviation;
    count_ += 1.0;
  }

 private:
  kiss_icp::Config config_;
  double count_ = 1.0;  ///< of errors
  double squared_sum_;  ///< of errors, m^2
};

}  // namespace lidarena::odometry::kiss_icp_head
