// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>

#include "lidarena/flight/flight.hpp"
#include "lidarena/flight/flight_config.hpp"
#include "lidarena/flight/uniform_spline.hpp"

namespace lidarena {

/// A flight along the line through waypoints, from rest to rest.
///
/// 1. The line's corners are rounded by arcs (round_corners).
/// 2. A point runs along it as fast as speed, acceleration and turn rate allow (TimeLaw).
/// 3. Its positions, taken once per knot, are the control points of a B-spline of degree 6 in
///    (x, y, z, yaw): the flight's flat outputs, from which attitude and rates follow (flatness).
///
/// Since the spline's derivatives are averages of the point's, speed and acceleration hold at every
/// instant what they hold for the point; the knot spacing 2 a / j bounds the jerk by j; and the
/// path stays within corner_m of the line. Tilt is at most asin(a / g). Position is five times
/// continuously differentiable, attitude three times.
class SplineFlight final : public Flight {
 public:
  static constexpr int kDegree = 6;
  using Spline = UniformSpline<kDegree, 4>;

  /// Uses what concerns the path's shape, speed and heading in `config`. Throws InputError (naming
  /// `place`) when waypoints are too few or repeat, a sweep exceeds the yaw rate, or `duration_s`
  /// leaves no time to move.
  SplineFlight(std::span<const Eigen::Vector3d> waypoints, const FlightConfig& config,
               const std::string& place);

  Motion at(Time t) const override;
  Pose pose_at(Time t) const override;
  Time duration() const override { return duration_; }

 private:
  struct Plan {
    Spline spline;
    Time duration;
  };
  static Plan plan(std::span<const Eigen::Vector3d> waypoints, const FlightConfig& config,
                   const std::string& place);
  explicit SplineFlight(Plan plan) : spline_(std::move(plan.spline)), duration_(plan.duration) {}

  Spline::Place find(Time t) const;

  Spline spline_;
  Time duration_;
};

}  // namespace lidarena
