// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/kiss_icp/adaptive_threshold.hpp"

#include <cmath>

namespace lidarena::odometry::kiss_icp {

double AdaptiveThreshold::sigma() const {
  return counting_ && count_ > 0.0 ? std::sqrt(squared_sum_ / count_) : config_.initial_threshold_m;
}

void AdaptiveThreshold::observe(const Pose& prediction, const Pose& estimate) {
  constexpr double kMotionsToMove = 5.0;
  counting_ = estimate.translation().norm() > kMotionsToMove * config_.min_motion_m;
  const double deviation = displacement(prediction.inverse() * estimate, config_.max_range_m);
  if (!counting_ || !(deviation > config_.min_motion_m)) return;
  squared_sum_ += deviation * deviation;
  count_ += 1.0;
}

}  // namespace lidarena::odometry::kiss_icp
