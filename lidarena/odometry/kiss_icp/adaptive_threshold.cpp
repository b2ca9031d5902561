// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/kiss_icp/adaptive_threshold.hpp"

#include <algorithm>
#include <cmath>

#include "lidarena/base/so3.hpp"

namespace lidarena::odometry::kiss_icp {

double displacement(const Pose& error, double range) {
  return error.translation().norm() + 2.0 * range * std::sin(0.5 * so3::angle(error.linear()));
}

AdaptiveThreshold::AdaptiveThreshold(const Config& config)
    : initial_(config.initial_threshold_m),
      min_motion_(config.min_motion_m),
      range_(config.max_range_m),
      start_(config.threshold_start),
      lever_(config.threshold_lever),
      kept_(config.threshold_memory ? std::exp(-1.0 / *config.threshold_memory) : 1.0) {
  if (start_ == ThresholdStart::kUntilMoved) return;
  squared_sum_ = initial_ * initial_;
  count_ = 1.0;
}

double AdaptiveThreshold::sigma() const {
  const bool initial = count_ == 0.0 || (start_ == ThresholdStart::kUntilMoved && !moved_);
  return initial ? initial_ : std::sqrt(squared_sum_ / count_);
}

void AdaptiveThreshold::observe(const Pose& prediction, const Pose& estimate, double mean_range) {
  constexpr double kMotionsToMove = 5.0;  // the 2023 program's constant
  moved_ = moved_ || estimate.translation().norm() > kMotionsToMove * min_motion_;
  const double lever = lever_ == ThresholdLever::kMeanRange ? mean_range : range_;
  double deviation = displacement(prediction.inverse() * estimate, lever);
  // With a memory, small errors must count too; otherwise slow motion would never reduce sigma.
  if (kept_ < 1.0)
    deviation = std::max(deviation, min_motion_);
  else if (!(deviation > min_motion_))
    return;
  squared_sum_ = kept_ * squared_sum_ + deviation * deviation;
  count_ = kept_ * count_ + 1.0;
}

}  // namespace lidarena::odometry::kiss_icp
