// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lidarena/base/pose.hpp"
#include "lidarena/base/time.hpp"

namespace lidarena {

struct StampedPose {
  Time stamp{0};
  Pose world_from_body = Pose::Identity();
};

/// Poses at strictly increasing instants, for ground truth and estimates.
class Trajectory {
 public:
  Trajectory() = default;
  /// Throws InputError (place `name`) when stamps do not strictly increase or a pose is not finite.
  explicit Trajectory(std::vector<StampedPose> poses, std::string name = "trajectory");

  /// Linear in position, slerp in rotation between the two bracketing poses; empty outside the span
  /// (never extrapolates).
  std::optional<Pose> at(Time t) const;
  /// Index of the first pose later than `t` (0..size()).
  std::size_t upper_bound(Time t) const;

  std::span<const StampedPose> poses() const { return poses_; }
  bool empty() const { return poses_.empty(); }
  std::size_t size() const { return poses_.size(); }
  /// First and last stamp; the trajectory must not be empty.
  Time begin_time() const { return poses_.front().stamp; }
  Time end_time() const { return poses_.back().stamp; }
  /// Sum of the straight-line distances between successive poses, m.
  double path_length() const;

 private:
  std::vector<StampedPose> poses_;
};

/// The same poses in another world.
Trajectory transformed(const Pose& new_from_old, const Trajectory& trajectory);

}  // namespace lidarena
