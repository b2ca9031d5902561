// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/stages/motion_record.hpp"

#include <chrono>
#include <optional>

namespace lidarena::stages {
namespace {

constexpr Time kStep = std::chrono::milliseconds(5);

}  // namespace

void MotionRecord::add(const odometry::ScanResult& result) {
  const bool revises = !result.revised.empty() && !scans_.empty() &&
                       scans_.back().stamp == result.revised.back().stamp;
  if (revises) {
    scans_.pop_back();
    steps_.resize(scans_.empty() ? 0 : scans_.back().end);
    add(result.revised.back(), result.revised);
  }
  add(result.estimate, result.motion);
}

void MotionRecord::add(const StampedPose& estimate, std::span<const StampedPose> motion) {
  const Pose body_from_world = estimate.world_from_body.inverse();
  std::optional<Time> last;
  for (const StampedPose& pose : motion) {
    const bool is_end = &pose == &motion.back();
    if (last && pose.stamp - *last < kStep && !is_end) continue;
    last = pose.stamp;
    const Pose relative = body_from_world * pose.world_from_body;
    steps_.push_back({static_cast<std::int32_t>((pose.stamp - estimate.stamp).count()),
                      relative.translation().cast<float>(),
                      Eigen::Quaterniond(relative.linear()).cast<float>()});
  }
  if (motion.empty()) steps_.emplace_back();
  any_ = any_ || motion.size() > 1;
  scans_.push_back({estimate.stamp, steps_.size()});
}

Trajectory MotionRecord::along(const Trajectory& trajectory) const {
  std::vector<StampedPose> poses;
  std::size_t next = 0;
  for (const ScanMotion& scan : scans_) {
    const std::optional<Pose> world_from_body = any_ ? trajectory.at(scan.stamp) : std::nullopt;
    for (; next < scan.end; ++next) {
      const Step& step = steps_[next];
      const Time stamp = scan.stamp + Time{step.dt_ns};
      if (!world_from_body || (!poses.empty() && stamp <= poses.back().stamp)) continue;
      Pose relative = Pose::Identity();
      relative.linear() = step.rotation.cast<double>().normalized().toRotationMatrix();
      relative.translation() = step.translation.cast<double>();
      poses.push_back({stamp, *world_from_body * relative});
    }
  }
  return Trajectory(std::move(poses), "motion");
}

}  // namespace lidarena::stages
