// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>

#include "lidarena/flight/flight.hpp"
#include "lidarena/flight/flight_config.hpp"
#include "lidarena/flight/uniform_spline.hpp"

namespace lidarena::flight {

/// A flight along the polyline through waypoints, from rest to rest.
///
/// 1. The corners of the polyline are rounded by arcs (round_corners).
/// 2. A point moves along it as fast as the limits on speed, acceleration and turn rate allow
///    (TimeLaw).
/// 3. Its positions, sampled once per knot, are the control points of a B-spline of degree 6 in
///    (x, y, z, yaw): the flight's flat outputs, from which attitude and rates follow (flatness).
///
/// Since the spline's derivatives are averages of those of the point, the limits on speed and
/// acceleration hold at every instant; the knot spacing 2 a / j limits the jerk to j; and the path
/// stays within corner_m of the polyline. Tilt is at most asin(a / g). Position is five times
/// continuously differentiable, attitude three times.
class SplineFlight final : public Flight {
 public:
  static constexpr int kDegree = 6;
  using Spline = UniformSpline<kDegree, 4>;

  /// Uses the settings of `config` for path, limits, heading, duration and hovering. Throws
  /// InputError (place `place`) when there are too few waypoints or one is repeated, a sweep
  /// exceeds the maximum yaw rate, or `duration_s` leaves no time to move.
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

}  // namespace lidarena::flight
