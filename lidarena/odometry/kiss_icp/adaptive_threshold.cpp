// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/kiss_icp/adaptive_threshold.hpp"

#include <cmath>

#include "lidarena/base/so3.hpp"

namespace lidarena::odometry::kiss_icp {

double displacement(const Pose& error, double range) {
  return error.translation().norm() + 2.0 * range * std::sin(0.5 * so3::angle(error.linear()));
}

AdaptiveThreshold::AdaptiveThreshold(const Config& config)
    : release_(config.release),
      initial_(config.initial_threshold_m),
      min_motion_(config.min_motion_m),
      range_(config.max_range_m),
      counting_(counts_errors_at(release_, Pose::Identity(), min_motion_)),
      count_(initial_samples(release_)),
      squared_sum_(count_ * initial_ * initial_) {}

double AdaptiveThreshold::sigma() const {
  return counting_ && count_ > 0.0 ? std::sqrt(squared_sum_ / count_) : initial_;
}

void AdaptiveThreshold::observe(const Pose& prediction, const Pose& estimate) {
  counting_ = counts_errors_at(release_, estimate, min_motion_);
  const double deviation = displacement(prediction.inverse() * estimate, range_);
  if (!counting_ || !(deviation > min_motion_)) return;
  squared_sum_ += deviation * deviation;
  count_ += 1.0;
}

}  // namespace lidarena::odometry::kiss_icp
