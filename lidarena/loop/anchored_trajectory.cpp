// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/loop/anchored_trajectory.hpp"

#include "lidarena/base/se3.hpp"

namespace lidarena::loop {

void AnchoredTrajectory::add_anchor(Time stamp, const Pose& previous_from_this) {
  anchors_.push_back({stamp, previous_from_this});
}

void AnchoredTrajectory::add(Time stamp, const Pose& anchor_from_body) {
  if (!poses_.empty() && stamp <= poses_.back().stamp) return;
  poses_.push_back({stamp, anchors_.size(), anchor_from_body});
}

void AnchoredTrajectory::revise(Time stamp, const Pose& anchor_from_body) {
  if (!poses_.empty() && poses_.back().stamp == stamp)
    poses_.back().anchor_from_body = anchor_from_body;
}

std::vector<StampedPose> AnchoredTrajectory::placed(std::span<const Pose> anchors) const {
  std::vector<StampedPose> placed;
  placed.reserve(poses_.size());
  for (const AnchoredPose& pose : poses_) {
    const std::size_t next = pose.anchors;
    if (next == 0) {
      placed.push_back({pose.stamp, pose.anchor_from_body});
      continue;
    }
    Pose world_from_anchor = anchors[next - 1];
    if (next < anchors_.size()) {
      const Pose bent =
          world_from_anchor.inverse() * anchors[next] * anchors_[next].previous_from_this.inverse();
      const Time begin = anchors_[next - 1].stamp;
      const double share =
          to_seconds(pose.stamp - begin) / to_seconds(anchors_[next].stamp - begin);
      world_from_anchor = world_from_anchor * se3::exp(share * se3::log(bent));
    }
    placed.push_back({pose.stamp, orthonormalized(world_from_anchor * pose.anchor_from_body)});
  }
  return placed;
}

std::uint64_t AnchoredTrajectory::memory_bytes() const {
  return anchors_.capacity() * sizeof(Anchor) + poses_.capacity() * sizeof(AnchoredPose);
}

}  // namespace lidarena::loop
