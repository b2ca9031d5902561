// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/trajectory/arc_length.hpp"

#include <algorithm>
#include <cmath>

namespace lidarena::evaluation {

TimeSpan common_span(const Trajectory& a, const Trajectory& b) {
  if (a.empty() || b.empty()) return {Time{0}, Time{-1}};
  return {std::max(a.begin_time(), b.begin_time()), std::min(a.end_time(), b.end_time())};
}

ArcLength::ArcLength(const Trajectory& trajectory, TimeSpan span) {
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  for (const StampedPose& pose : trajectory.poses()) {
    if (pose.stamp < span.begin || pose.stamp > span.end) continue;
    const Eigen::Vector3d& position = pose.world_from_body.translation();
    s_.push_back(t_.empty() ? 0.0 : s_.back() + (position - last).norm());
    t_.push_back(pose.stamp);
    last = position;
  }
}

Time ArcLength::time_at(double s) const {
  const auto next = std::lower_bound(s_.begin(), s_.end(), s);
  if (next == s_.begin()) return t_.front();
  if (next == s_.end()) return t_.back();
  const auto i = static_cast<std::size_t>(next - s_.begin());
  const double share = (s - s_[i - 1]) / (s_[i] - s_[i - 1]);
  const auto step = static_cast<double>((t_[i] - t_[i - 1]).count());
  return t_[i - 1] + Time{std::llround(share * step)};
}

double ArcLength::at(Time t) const {
  const auto next = std::lower_bound(t_.begin(), t_.end(), t);
  if (next == t_.begin()) return s_.front();
  if (next == t_.end()) return s_.back();
  const auto i = static_cast<std::size_t>(next - t_.begin());
  if (*next == t) return s_[i];
  const double share = static_cast<double>((t - t_[i - 1]).count()) /
                       static_cast<double>((t_[i] - t_[i - 1]).count());
  return s_[i - 1] + share * (s_[i] - s_[i - 1]);
}

}  // namespace lidarena::evaluation
