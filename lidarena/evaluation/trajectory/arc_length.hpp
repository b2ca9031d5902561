// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "lidarena/base/trajectory.hpp"

namespace lidarena::evaluation {

/// From `begin` to `end`, both inclusive.
struct TimeSpan {
  Time begin{0};
  Time end{0};
};

/// Common time span of both trajectories; empty (end < begin) when they do not overlap.
TimeSpan common_span(const Trajectory& a, const Trajectory& b);

/// Path length s(t) in meters at a trajectory's own stamps within a span; zero at the first of
/// them.
class ArcLength {
 public:
  ArcLength(const Trajectory& trajectory, TimeSpan span);

  bool empty() const { return s_.empty(); }
  /// Length of the whole path, m; zero when empty.
  double length() const { return s_.empty() ? 0.0 : s_.back(); }
  /// First instant at which the path length is `s`, linear between stamps, held at both ends; must
  /// not be empty.
  Time time_at(double s) const;
  /// Path length at `t`, linear between stamps, held at both ends; must not be empty.
  double at(Time t) const;

 private:
  std::vector<Time> t_;
  std::vector<double> s_;
};

}  // namespace lidarena::evaluation
