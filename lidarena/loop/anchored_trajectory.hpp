// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lidarena/base/pose.hpp"
#include "lidarena/base/trajectory.hpp"

namespace lidarena {

/// Poses that hang on keyframes, so that they move along when those are moved afterwards. What the
/// keyframes' new places ask of the motion between two of them is shared out evenly over its time.
class AnchoredTrajectory {
 public:
  /// A new keyframe at `stamp`, and where it stood when seen from the one before.
  void add_anchor(Time stamp, const Pose& previous_from_this);
  /// A pose seen from the last keyframe; from the world, as long as there is none. Poses not later
  /// than the one before are left out.
  void add(Time stamp, const Pose& anchor_from_body);

  /// All poses, the keyframes being at `anchors` now (as many as were added).
  std::vector<StampedPose> placed(std::span<const Pose> anchors) const;

  std::size_t size() const { return poses_.size(); }
  std::uint64_t memory_bytes() const;

 private:
  struct Anchor {
    Time stamp{0};
    Pose previous_from_this = Pose::Identity();
  };
  struct Hanging {
    Time stamp{0};
    std::size_t anchors = 0;  ///< that there were; it hangs on the last of them
    Pose anchor_from_body = Pose::Identity();
  };
  std::vector<Anchor> anchors_;
  std::vector<Hanging> poses_;
};

}  // namespace lidarena
