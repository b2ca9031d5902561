// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/pose_spline_flight.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "lidarena/flight/spline_fit.hpp"

namespace lidarena::flight {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using PoseSpline = PoseSplineFlight::Spline;
using Value = PoseSpline::Value;  // x y z of the position, x y z w of the quaternion

Quaterniond quaternion_of(const Value& value) {
  return Quaterniond(Eigen::Vector4d(value.tail<4>()));
}

/// Position and quaternion of a pose. Of the two quaternions of a rotation the one closer to that
/// of `last` is chosen.
Value value_of(const Pose& pose, const Value& last) {
  Quaterniond q(pose.linear());
  if (q.coeffs().dot(last.tail<4>()) < 0.0) q.coeffs() = -q.coeffs();
  Value value;
  value << pose.translation(), q.coeffs();
  return value;
}

PoseSpline fitted(const std::function<Pose(double)>& pose_at, double knot, Time duration) {
  const auto intervals = static_cast<std::size_t>(std::ceil(to_seconds(duration) / knot));
  const std::size_t count = intervals + PoseSplineFlight::kDegree + 2 * kFitReach;
  std::vector<Value> samples;
  samples.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) * knot - PoseSplineFlight::lead_s(knot);
    samples.push_back(value_of(pose_at(t), samples.empty() ? Value::Zero() : samples.back()));
  }
  return {controls_through<PoseSplineFlight::kDegree>(samples), knot};
}

}  // namespace

double PoseSplineFlight::lead_s(double knot_s) {
  return static_cast<double>(kFitReach) * knot_s - PoseSpline::center(0, knot_s);
}

PoseSplineFlight::PoseSplineFlight(const std::function<Pose(double)>& pose_at, double knot_s,
                                   Time duration)
    : spline_(fitted(pose_at, knot_s, duration)), duration_(duration) {}

PoseSpline::Place PoseSplineFlight::find(Time t) const {
  return spline_.find(to_seconds(std::clamp(t, Time{0}, duration_)));
}

Pose PoseSplineFlight::pose_at(Time t) const {
  const Value value = spline_.derivative<0>(find(t));
  return make_pose(quaternion_of(value), value.head<3>());
}

Motion PoseSplineFlight::at(Time t) const {
  const PoseSpline::Place place = find(t);
  const Value value = spline_.derivative<0>(place);
  Motion motion{.world_from_body = make_pose(quaternion_of(value), value.head<3>())};
  if (t < Time{0} || t > duration_) return motion;
  const Value first = spline_.derivative<1>(place);
  const Value second = spline_.derivative<2>(place);
  motion.velocity_world = first.head<3>();
  motion.acceleration_world = second.head<3>();
  // With s = n q the product conj(s) s' = n^2 conj(q) q' + n n': its vector part is n^2 rate / 2.
  // In its derivative, the term conj(s') s' has no vector part.
  const Quaterniond conjugate = quaternion_of(value).conjugate();
  const double n2 = value.tail<4>().squaredNorm();
  const double dn2 = 2.0 * value.tail<4>().dot(first.tail<4>());
  const Vector3d rate = 2.0 / n2 * (conjugate * quaternion_of(first)).vec();
  motion.angular_rate_body = rate;
  motion.angular_acceleration_body =
      2.0 / n2 * (conjugate * quaternion_of(second)).vec() - dn2 / n2 * rate;
  return motion;
}

}  // namespace lidarena::flight
