// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lidarena/base/pose.hpp"
#include "lidarena/base/trajectory.hpp"

namespace lidarena::loop {

/// Poses relative to keyframes, which move along when the keyframes are corrected later. The
/// correction of the motion between two keyframes is distributed evenly over the time between them.
class AnchoredTrajectory {
 public:
  /// Adds a keyframe at `stamp` with its pose relative to the one before.
  void add_anchor(Time stamp, const Pose& previous_from_this);
  /// Adds a pose relative to the last keyframe, or to the world as long as there is none. Poses not
  /// later than the one before are left out.
  void add(Time stamp, const Pose& anchor_from_body);

  /// Replaces the last pose, if it is at `stamp`; relative to the same as that.
  void revise(Time stamp, const Pose& anchor_from_body);

  /// All poses in the world, for keyframes at `anchors` (as many as were added).
  std::vector<StampedPose> placed(std::span<const Pose> anchors) const;

  std::size_t size() const { return poses_.size(); }
  std::uint64_t memory_bytes() const;

 private:
  struct Anchor {
    Time stamp{0};
    Pose previous_from_this = Pose::Identity();
  };
  struct AnchoredPose {
    Time stamp{0};
    std::size_t anchors = 0;  ///< number of keyframes so far; relative to the last of them
    Pose anchor_from_body = Pose::Identity();
  };
  std::vector<Anchor> anchors_;
  std::vector<AnchoredPose> poses_;
};

}  // namespace lidarena::loop
