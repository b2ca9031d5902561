// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "lidarena/flight/rounded_path.hpp"

namespace lidarena {

struct PathLimits {
  double max_speed = 1.0;         ///< m/s
  double max_acceleration = 1.0;  ///< m/s^2, of the vector: along and across the path together
  double max_turn_rate = 1.0;     ///< rad/s, of the path's direction
  double stop_s = 0.0;            ///< pause where the path turns on the spot
};

/// How far along its path a point has come, as a function of time: from rest to rest as fast as the
/// limits allow, at constant acceleration along the path in each of many short cells.
class TimeLaw {
 public:
  /// Along `path` up to the arc length `end` (0 < end <= length). The forward and backward pass
  /// over the speed limits is that of Bobrow, Dubowsky, Gibson (IJRR 1985) with their limits
  /// replaced by ours.
  TimeLaw(const RoundedPath& path, const PathLimits& limits, double end);

  double duration() const { return nodes_.back().arrival; }
  double distance_at(double t) const;  ///< m; ends are held
  double end() const { return nodes_.back().s; }

 private:
  struct Node {
    double s, speed;
    double arrival, departure;  ///< s; they differ at stops
  };
  /// Lowers the nodes' speeds to what neighbors allow with each cell's acceleration.
  void make_reachable(const std::vector<double>& along);

  std::vector<Node> nodes_;
};

/// The law that stops after `duration` s, which must not exceed that of the whole path.
TimeLaw law_of_duration(const RoundedPath& path, const PathLimits& limits, double duration);

}  // namespace lidarena
