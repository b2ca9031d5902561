// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/kiss_icp/adaptive_threshold.hpp"

#include <cmath>

#include "lidarena/base/so3.hpp"

namespace lidarena::odometry::kiss_icp {

double displacement(const Pose& error, double range) {
  return error.translation().norm() + 2.0 * range * std::sin(0.5 * so3::angle(error.linear()));
}

AdaptiveThreshold::AdaptiveThreshold(const Config& config)
    : config_(config),
      counting_(counts_errors_at(config.release, Pose::Identity(), config.min_motion_m)),
      count_(initial_samples(config.release)),
      squared_sum_(count_ * config.initial_threshold_m * config.initial_threshold_m) {}

double AdaptiveThreshold::sigma() const {
  return counting_ && count_ > 0.0 ? std::sqrt(squared_sum_ / count_) : config_.initial_threshold_m;
}

void AdaptiveThreshold::observe(const Pose& prediction, const Pose& estimate) {
  counting_ = counts_errors_at(config_.release, estimate, config_.min_motion_m);
  const double deviation = displacement(prediction.inverse() * estimate, config_.max_range_m);
  if (!counting_ || !(deviation > config_.min_motion_m)) return;
  squared_sum_ += deviation * deviation;
  count_ += 1.0;
}

}  // namespace lidarena::odometry::kiss_icp
