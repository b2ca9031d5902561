// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "lidarena/base/trajectory.hpp"

namespace lidarena {

/// From `begin` to `end`, both inclusive.
struct TimeSpan {
  Time begin{0};
  Time end{0};
};

/// What both trajectories span; empty (end < begin) when they do not meet.
TimeSpan common_span(const Trajectory& a, const Trajectory& b);

/// Path flown s(t) in meters, at a trajectory's own stamps within a span, zero at the first of
/// them.
class ArcLength {
 public:
  ArcLength(const Trajectory& trajectory, TimeSpan span);

  bool empty() const { return s_.empty(); }
  /// The whole path; zero when empty.
  double length() const { return s_.empty() ? 0.0 : s_.back(); }
  /// The first instant at which the path is `s` long, linear between stamps; must not be empty.
  Time time_at(double s) const;
  /// Path flown until `t`, linear between stamps, held at both ends; must not be empty.
  double at(Time t) const;

 private:
  std::vector<Time> t_;
  std::vector<double> s_;
};

}  // namespace lidarena
