// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include "lidarena/flight/flight.hpp"
#include "lidarena/flight/uniform_spline.hpp"

namespace lidarena::flight {

/// A flight along poses that were computed at equal time steps: one B-spline of degree 6 in
/// position and quaternion (the quaternion is divided by its norm, which is close to 1), so that
/// velocity, acceleration, body rate and angular acceleration are exact derivatives of the pose.
/// Five times continuously differentiable. 392 bytes per knot.
class PoseSplineFlight final : public Flight {
 public:
  static constexpr int kDegree = 6;
  using Spline = UniformSpline<kDegree, 7>;
  /// Time (s) before 0 at which the first pose is sampled.
  static double lead_s(double knot_s);

  /// `pose_at(t)`, t in s, is called once per knot in order of time, from -lead_s() on, at most
  /// until lead_s() plus one knot after `duration`.
  PoseSplineFlight(const std::function<Pose(double)>& pose_at, double knot_s, Time duration);
  /// The spline of these control points (x y z of the position in m, x y z w of the quaternion).
  PoseSplineFlight(const std::vector<Spline::Value>& controls, double knot_s, Time duration)
      : spline_(controls, knot_s), duration_(duration) {}

  Motion at(Time t) const override;
  Pose pose_at(Time t) const override;
  Time duration() const override { return duration_; }

 private:
  Spline::Place find(Time t) const;

  Spline spline_;
  Time duration_;
};

}  // namespace lidarena::flight
