// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/step_flight.hpp"

#include "lidarena/base/so3.hpp"

namespace lidarena::sensor {

using Eigen::Vector3d;

namespace {

/// First and second derivative at zero of the parabola through (-before, at_before), (0, 0) and
/// (after, at_after).
struct Parabola {
  Vector3d first, second;
  Parabola(double before, const Vector3d& at_before, double after, const Vector3d& at_after) {
    const Vector3d slope_before = -at_before / before, slope_after = at_after / after;
    first = (after * slope_before + before * slope_after) / (before + after);
    second = 2.0 * (slope_after - slope_before) / (before + after);
  }
};

}  // namespace

StepFlight::StepFlight(const std::array<StampedPose, 3>& poses)
    : middle_time_(poses[1].stamp), end_(poses[2].stamp), middle_(poses[1].world_from_body) {
  const Pose& first = poses[0].world_from_body;
  const Pose& last = poses[2].world_from_body;
  const double before = to_seconds(poses[1].stamp - poses[0].stamp);
  const double after = to_seconds(poses[2].stamp - poses[1].stamp);
  const Parabola position_fit(before, first.translation() - middle_.translation(), after,
                              last.translation() - middle_.translation());
  velocity_ = position_fit.first;
  acceleration_ = position_fit.second;
  const Eigen::Matrix3d to_middle = middle_.linear().transpose();
  const Parabola rotation_fit(before, so3::log(to_middle * first.linear()), after,
                              so3::log(to_middle * last.linear()));
  rate_ = rotation_fit.first;
  angular_acceleration_ = rotation_fit.second;
}

flight::Motion StepFlight::at(Time t) const {
  const double s = to_seconds(t - middle_time_);
  flight::Motion motion;
  motion.world_from_body = middle_;
  motion.world_from_body.translation() += s * velocity_ + 0.5 * s * s * acceleration_;
  motion.world_from_body.linear() *= so3::exp(s * rate_ + 0.5 * s * s * angular_acceleration_);
  motion.velocity_world = velocity_ + s * acceleration_;
  motion.acceleration_world = acceleration_;
  motion.angular_rate_body = rate_ + s * angular_acceleration_;
  motion.angular_acceleration_body = angular_acceleration_;
  return motion;
}

}  // namespace lidarena::sensor
