// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/base/trajectory.hpp"

#include <algorithm>

#include "lidarena/base/error.hpp"

namespace lidarena {

Trajectory::Trajectory(std::vector<StampedPose> poses, std::string name)
    : poses_(std::move(poses)) {
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    const std::string place = name + ": pose " + std::to_string(i + 1);
    if (!poses_[i].world_from_body.matrix().allFinite()) {
      throw InputError(place, "is not finite (NaN or infinity)",
                       "the estimator has diverged there; cut the file before this pose");
    }
    if (i > 0 && poses_[i].stamp <= poses_[i - 1].stamp) {
      throw InputError(place, "its time is not later than that of the pose before",
                       "sort the poses by time and remove duplicates");
    }
  }
}

std::size_t Trajectory::upper_bound(Time t) const {
  const auto later = [](Time a, const StampedPose& b) { return a < b.stamp; };
  return static_cast<std::size_t>(std::upper_bound(poses_.begin(), poses_.end(), t, later) -
                                  poses_.begin());
}

std::optional<Pose> Trajectory::at(Time t) const {
  if (poses_.empty() || t < begin_time() || t > end_time()) return std::nullopt;
  const std::size_t next = upper_bound(t);
  if (next == poses_.size()) return poses_.back().world_from_body;
  const StampedPose& a = poses_[next - 1];
  const StampedPose& b = poses_[next];
  if (t == a.stamp) return a.world_from_body;
  const double s =
      static_cast<double>((t - a.stamp).count()) / static_cast<double>((b.stamp - a.stamp).count());
  return interpolate(a.world_from_body, b.world_from_body, s);
}

double Trajectory::path_length() const {
  double length = 0.0;
  for (std::size_t i = 1; i < poses_.size(); ++i) {
    length +=
        (poses_[i].world_from_body.translation() - poses_[i - 1].world_from_body.translation())
            .norm();
  }
  return length;
}

Trajectory transformed(const Pose& new_from_old, const Trajectory& trajectory) {
  std::vector<StampedPose> poses(trajectory.poses().begin(), trajectory.poses().end());
  for (StampedPose& pose : poses) pose.world_from_body = new_from_old * pose.world_from_body;
  return Trajectory(std::move(poses));
}

}  // namespace lidarena
