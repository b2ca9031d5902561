// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/with_loop.hpp"

#include "lidarena/base/so3.hpp"
#include "lidarena/map/voxel_filter.hpp"

namespace lidarena::odometry {
namespace {

constexpr std::size_t kTiedKeyframes = 40;  // that the last loop ties to those of the first visit

}  // namespace

OdometryTraits WithLoop::traits() const {
  OdometryTraits traits = odometry_->traits();
  traits.revises_past = true;
  traits.publishes_scans = false;
  return traits;
}

ScanResult WithLoop::track(const Scan& scan) {
  ScanResult result = odometry_->register_scan(scan);
  if (result.status == ScanStatus::kDiverged) return result;
  const Time stamp = result.estimate.stamp;
  const Pose odom_from_body = result.estimate.world_from_body;
  if (!result.revised.empty()) {
    const StampedPose& before = result.revised.back();
    poses_.revise(before.stamp, in_keyframe(before.world_from_body));
  }
  const bool usable = result.status != ScanStatus::kTooFewPoints &&
                      result.status != ScanStatus::kInitializing &&
                      !odometry_->registered_scan().empty();
  if (usable && is_keyframe(odom_from_body)) keep(stamp, odom_from_body);
  poses_.add(stamp, in_keyframe(odom_from_body));
  result.counters.loops = closer_.accepted();
  result.details.emplace_back("keyframes", clouds_.size());
  result.details.emplace_back("loops_tried", closer_.records().size());
  return corrected(std::move(result));
}

ScanResult WithLoop::corrected(ScanResult result) const {
  const auto move = [this](Pose& pose) { pose = orthonormalized(world_from_odom_ * pose); };
  move(result.estimate.world_from_body);
  for (std::vector<StampedPose>* poses : {&result.motion, &result.revised}) {
    for (StampedPose& pose : *poses) move(pose.world_from_body);
  }
  const Eigen::Matrix3d rotation = world_from_odom_.linear();
  if (result.covariance) {
    auto turned = Eigen::Matrix<double, 6, 6>::Identity().eval();
    turned.topLeftCorner<3, 3>() = rotation;
    result.covariance = turned * *result.covariance * turned.transpose();
  }
  if (result.up) result.up->direction = rotation * result.up->direction;
  result.world_from_odom = world_from_odom_ * result.world_from_odom;
  return result;
}

Pose WithLoop::in_keyframe(const Pose& odom_from_body) const {
  return clouds_.empty() ? odom_from_body : Pose(odom_from_keyframe_.inverse() * odom_from_body);
}

bool WithLoop::is_keyframe(const Pose& odom_from_body) const {
  if (clouds_.empty()) return true;
  const Pose moved = odom_from_keyframe_.inverse() * odom_from_body;
  return moved.translation().norm() >= config_.keyframe_translation_m ||
         so3::angle(moved.linear()) >= config_.keyframe_rotation_rad;
}

void WithLoop::take_first_poses(Time until) {
  const Trajectory revised = odometry_->trajectory();
  poses_ = {};
  for (const StampedPose& pose : revised.poses())
    if (pose.stamp < until) poses_.add(pose.stamp, pose.world_from_body);
}

void WithLoop::keep(Time stamp, const Pose& odom_from_body) {
  if (clouds_.empty()) take_first_poses(stamp);
  const std::vector<Eigen::Vector3f> cloud =
      transformed(odom_from_body.inverse(), odometry_->registered_scan());
  const Pose previous_from_this = in_keyframe(odom_from_body);
  clouds_.push_back(map::voxel_means(cloud, config_.cloud_voxel_size_m));
  poses_.add_anchor(stamp, previous_from_this);
  odom_from_keyframe_ = odom_from_body;
  closer_.add(stamp, previous_from_this, [this](std::size_t keyframe) {
    return std::span<const Eigen::Vector3f>(clouds_[keyframe]);
  });
  world_from_odom_ = closer_.poses().back() * odom_from_body.inverse();
  retire_revisit();
}

void WithLoop::retire_revisit() {
  if (clouds_.size() <= loop::LoopCloser::kSourceReach) return;
  const std::size_t revisit = clouds_.size() - 1 - loop::LoopCloser::kSourceReach;
  if (revisit > closer_.closed_until() + kTiedKeyframes) return;
  const Pose keyframe_from_world = closer_.poses()[revisit].inverse();
  for (std::size_t first = 0; first < revisit; ++first) {
    const Pose apart = keyframe_from_world * closer_.poses()[first];
    if (clouds_[first].empty() || apart.translation().norm() >= config_.keyframe_translation_m ||
        so3::angle(apart.linear()) >= config_.keyframe_rotation_rad)
      continue;
    clouds_[revisit] = std::vector<Eigen::Vector3f>();  // {} would keep the memory
    return closer_.retire(revisit);
  }
}

Trajectory WithLoop::trajectory() const {
  return Trajectory(poses_.placed(closer_.poses()), "with_loop");
}

std::vector<Eigen::Vector3f> WithLoop::map() const {
  std::vector<Eigen::Vector3f> points;
  for (std::size_t i = 0; i < clouds_.size(); ++i)
    append_transformed(closer_.poses()[i], clouds_[i], points);
  return points;
}

MemoryUse WithLoop::memory() const {
  MemoryUse memory = odometry_->memory();
  for (const auto& cloud : clouds_) memory.map += cloud.capacity() * sizeof(Eigen::Vector3f);
  memory.other += closer_.memory_bytes() + poses_.memory_bytes();
  return memory;
}

}  // namespace lidarena::odometry
