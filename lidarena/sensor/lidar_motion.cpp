// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/lidar_motion.hpp"

#include <algorithm>

namespace lidarena::sensor {
namespace {

constexpr std::int64_t kStep = 1'333'332;  // ns between samples; even, so that half is an integer
constexpr std::int64_t kSegment = 3 * kStep;
constexpr double kPositionTolerance = 1e-7;  // m
constexpr double kRotationTolerance = 1e-9;  // per matrix element; 1e-7 m at 100 m

}  // namespace

LidarMotion::LidarMotion(const flight::Flight& flight, const Pose& body_from_lidar, Time stamp,
                         std::int32_t last_dt_ns, bool rolling)
    : flight_(flight), body_from_lidar_(body_from_lidar), stamp_(stamp) {
  samples_.push_back(exact(Time{0}).matrix().topRows<3>());
  if (!rolling) return;
  const auto segments = static_cast<std::size_t>(last_dt_ns / kSegment + 1);
  for (std::size_t i = 1; i <= 3 * segments; ++i) {
    samples_.push_back(exact(Time{static_cast<std::int64_t>(i) * kStep}).matrix().topRows<3>());
  }
  for (std::size_t i = 0; i < segments; ++i) smooth_.push_back(is_smooth(i));
}

Pose LidarMotion::exact(Time after_stamp) const {
  return flight_.pose_at(stamp_ + after_stamp) * body_from_lidar_;
}

/// Lagrange polynomial through the samples at x = 0, 1, 2, 3.
LidarMotion::Matrix34 LidarMotion::cubic(std::size_t segment, double x) const {
  const double x1 = x - 1.0, x2 = x - 2.0, x3 = x - 3.0;
  const Matrix34* sample = &samples_[3 * segment];
  return (-x1 * x2 * x3 / 6.0) * sample[0] + (x * x2 * x3 / 2.0) * sample[1] +
         (-x * x1 * x3 / 2.0) * sample[2] + (x * x1 * x2 / 6.0) * sample[3];
}

bool LidarMotion::is_smooth(std::size_t segment) const {
  const auto begin = static_cast<std::int64_t>(segment) * kSegment;
  for (int gap = 0; gap < 3; ++gap) {
    const Time middle{begin + gap * kStep + kStep / 2};
    const Matrix34 off = cubic(segment, gap + 0.5) - exact(middle).matrix().topRows<3>();
    if (off.leftCols<3>().cwiseAbs().maxCoeff() > kRotationTolerance) return false;
    if (off.col(3).cwiseAbs().maxCoeff() > kPositionTolerance) return false;
  }
  return true;
}

Pose LidarMotion::at(std::int32_t dt_ns) const {
  Pose pose;
  if (smooth_.empty()) {
    pose.matrix().topRows<3>() = samples_.front();
  } else {
    const auto segment = static_cast<std::size_t>(dt_ns / kSegment);
    if (segment >= smooth_.size() || !smooth_[segment]) return exact(Time{dt_ns});
    const auto within = static_cast<double>(dt_ns - static_cast<std::int64_t>(segment) * kSegment);
    pose.matrix().topRows<3>() = cubic(segment, within / static_cast<double>(kStep));
  }
  pose.makeAffine();
  return pose;
}

double LidarMotion::exact_share() const {
  if (smooth_.empty()) return 0.0;
  return static_cast<double>(std::ranges::count(smooth_, false)) /
         static_cast<double>(smooth_.size());
}

}  // namespace lidarena::sensor
