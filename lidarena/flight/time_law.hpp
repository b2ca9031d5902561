// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "lidarena/flight/rounded_path.hpp"

namespace lidarena::flight {

struct PathLimits {
  double max_speed = 1.0;         ///< m/s
  double max_acceleration = 1.0;  ///< m/s^2, norm of the parts along and across the path
  double max_turn_rate = 1.0;     ///< rad/s, of the path's direction
  double stop_s = 0.0;            ///< s, pause at stops
};

/// Arc length along a path as a function of time: from rest to rest as fast as the limits allow,
/// with constant acceleration along the path in each of many short cells.
class TimeLaw {
 public:
  /// Along `path` up to the arc length `end` (0 < end <= length). The forward and backward passes
  /// over the speed limits are those of Bobrow, Dubowsky, Gibson (IJRR 1985), with the limits of
  /// `limits` instead of theirs.
  TimeLaw(const RoundedPath& path, const PathLimits& limits, double end);

  double duration() const { return nodes_.back().arrival; }
  double distance_at(double t) const;  ///< arc length, m; constant outside [0, duration()]
  double end() const { return nodes_.back().s; }

 private:
  struct Node {
    double s, speed;
    double arrival, departure;  ///< s; they differ at stops
  };
  /// Reduces the speeds of the nodes to those reachable from their neighbors with the acceleration
  /// limit of each cell.
  void make_reachable(const std::vector<double>& along);

  std::vector<Node> nodes_;
};

/// The time law that comes to rest after `duration` (s), which must not exceed that of the whole
/// path.
TimeLaw law_of_duration(const RoundedPath& path, const PathLimits& limits, double duration);

}  // namespace lidarena::flight
