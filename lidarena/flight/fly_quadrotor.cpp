// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/fly_quadrotor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lidarena/base/error.hpp"
#include "lidarena/base/so3.hpp"
#include "lidarena/flight/geometric_controller.hpp"
#include "lidarena/flight/gusts.hpp"
#include "lidarena/flight/pose_spline_flight.hpp"
#include "lidarena/flight/quadrotor.hpp"

namespace lidarena::flight {
namespace {

constexpr double kStep = 0.002;      // s; a tenth of a rotor's lag: order 4 has errors of 1e-6
constexpr double kKnot = 4 * kStep;  // s; samples at odd multiples of half a knot are even steps
constexpr double kMaxError = 3.0;    // m, position error above which tracking has failed

double hover_speed(const DynamicsConfig& config, const std::string& place) {
  const double share = config.mass_kg * kGravity / (4.0 * config.max_thrust);
  if (share < 1.0) return std::sqrt(share);
  throw InputError(place,
                   fmt::format("the quadrotor cannot lift itself: 4 rotors of {:g} N, {:g} kg",
                               config.max_thrust, config.mass_kg),
                   "increase dynamics.max_thrust or reduce dynamics.mass_kg");
}

/// Simulates a quadrotor that follows the reference, step by step.
class Pilot {
 public:
  Pilot(const Flight& reference, const DynamicsConfig& config, const std::string& place)
      : reference_(reference), quadrotor_(config), gusts_(config.gusts), place_(place) {
    const Pose start = reference.pose_at(Time{0});
    state_.position = start.translation();
    state_.attitude = Eigen::Quaterniond(start.linear());
    state_.rotor_speed.setConstant(hover_speed(config, place));
  }

  /// The pose at `t` (s); `t` must not decrease from call to call.
  Pose pose_at(double t) {
    if (steps_ == kUnset) steps_ = steps_until(t);
    for (const std::int64_t last = steps_until(t); steps_ < last; ++steps_) {
      const auto rate = [&](double s, const QuadrotorState& state) { return derivative(s, state); };
      state_ = runge_kutta(state_, static_cast<double>(steps_) * kStep, kStep, rate);
    }
    require_near(t);
    return make_pose(state_.attitude, state_.position);
  }

 private:
  static constexpr std::int64_t kUnset = std::numeric_limits<std::int64_t>::min();
  static std::int64_t steps_until(double t) { return std::llround(t / kStep); }

  QuadrotorRate derivative(double t, const QuadrotorState& state) const {
    const Wrench wrench = tracking_wrench(quadrotor_, state, reference_.at(from_seconds(t)));
    return quadrotor_.derivative(state, quadrotor_.speeds_for(wrench), gusts_.at(t));
  }

  void require_near(double t) const {
    const Eigen::Vector3d wanted = reference_.pose_at(from_seconds(t)).translation();
    if ((state_.position - wanted).norm() < kMaxError) return;  // false for NaN, too
    throw InputError(place_,
                     fmt::format("the quadrotor has lost the path {:.2f} s after the start", t),
                     "reduce limits (or choose a gentler style) or dynamics.gusts, or increase "
                     "dynamics.max_thrust");
  }

  const Flight& reference_;
  Quadrotor quadrotor_;
  Gusts gusts_;
  const std::string& place_;
  QuadrotorState state_;
  std::int64_t steps_ = kUnset;  ///< number of steps from t = 0; negative before t = 0
};

}  // namespace

std::unique_ptr<Flight> fly_quadrotor(const Flight& reference, const DynamicsConfig& config,
                                      const std::string& place) {
  Pilot pilot(reference, config, place);
  return std::make_unique<PoseSplineFlight>([&](double t) { return pilot.pose_at(t); }, kKnot,
                                            reference.duration());
}

TrackingError tracking_error(const Flight& flown, const Flight& reference) {
  constexpr Time kSpacing = std::chrono::milliseconds(5);
  TrackingError error;
  double squares = 0.0;
  int count = 0;
  for (Time t{0}; t <= flown.duration(); t += kSpacing, ++count) {
    const Pose difference = reference.pose_at(t).inverse() * flown.pose_at(t);
    const double distance = difference.translation().norm();
    squares += distance * distance;
    error.max_m = std::max(error.max_m, distance);
    error.max_angle = std::max(error.max_angle, so3::angle(difference.linear()));
  }
  error.rms_m = std::sqrt(squares / std::max(count, 1));
  return error;
}

}  // namespace lidarena::flight
