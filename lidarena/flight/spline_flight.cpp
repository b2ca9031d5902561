// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/spline_flight.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "lidarena/base/error.hpp"
#include "lidarena/flight/flatness.hpp"
#include "lidarena/flight/heading.hpp"
#include "lidarena/flight/rounded_path.hpp"
#include "lidarena/flight/time_law.hpp"

namespace lidarena::flight {
namespace {

using Eigen::Vector3d;
using Eigen::Vector4d;
using Spline = SplineFlight::Spline;
using std::numbers::pi;

/// Maximum acceleration on the path. It also respects the maximum tilt and limits the deviation by
/// the spline's smoothing to half of `corner`: a/2 variance knot^2 <= corner/2 with knot = 2 a / j.
double usable_acceleration(const FlightLimits& limits, double corner) {
  const double j = limits.max_jerk;
  return std::min({limits.max_acceleration, kGravity * std::sin(limits.max_tilt),
                   std::cbrt(corner * j * j / (4.0 * Spline::kVariance))});
}

/// Factor by which the spline's smoothing reduces the amplitude of a sine of this period.
double sweep_gain(double period_s, double knot) {
  const double x = pi * knot / period_s;
  return std::pow(std::sin(x) / x, SplineFlight::kDegree + 1);
}

/// The waypoints repeated (back and forth when the line is open) for at least `length` (m).
std::vector<Vector3d> repeated_line(std::span<const Vector3d> waypoints, double length) {
  constexpr double kClosed = 1e-3;  // m
  std::vector<Vector3d> lap(waypoints.begin(), waypoints.end());
  if ((lap.front() - lap.back()).norm() > kClosed) {
    lap.insert(lap.end(), waypoints.rbegin() + 1, waypoints.rend());
  }
  double lap_length = 0.0;
  for (std::size_t i = 1; i < lap.size(); ++i) lap_length += (lap[i] - lap[i - 1]).norm();
  const auto count = static_cast<int>(std::ceil(length / lap_length));
  std::vector<Vector3d> laps = lap;
  for (int i = 1; i < count; ++i) laps.insert(laps.end(), lap.begin() + 1, lap.end());
  return laps;
}

/// The amplitude (rad) of a sweep before smoothing, and its maximum yaw rate (rad/s).
struct Sweep {
  double amplitude = 0.0, rate = 0.0;
};

Sweep sweep_of(const HeadingConfig& heading, double knot, double max_yaw_rate,
               const std::string& place) {
  if (heading.mode != HeadingMode::kSweep) return {};
  const double gain = heading.period_s > knot ? sweep_gain(heading.period_s, knot) : 0.0;
  const double amplitude = heading.amplitude / gain;
  const double rate = 2.0 * pi * amplitude / heading.period_s;
  if (!(rate < max_yaw_rate)) {
    throw InputError(place,
                     fmt::format("the heading's sweep needs a yaw rate of {:.2f} rad/s, above the "
                                 "limit of {:.2f} rad/s",
                                 rate, max_yaw_rate),
                     "reduce heading.amplitude or increase heading.period_s or "
                     "limits.max_yaw_rate");
  }
  return {amplitude, rate};
}

/// Position and direction of the moving point at the instants of the control points, and the start
/// and end of its motion.
struct Course {
  std::vector<Vector3d> points, directions;
  double begin_s = 0.0, end_s = 0.0;
};

Course sample(const RoundedPath& path, const TimeLaw& law, double begin_s, double knot,
              std::size_t count) {
  Course course{
      .points = {}, .directions = {}, .begin_s = begin_s, .end_s = begin_s + law.duration()};
  for (std::size_t j = 0; j < count; ++j) {
    const double s = law.distance_at(Spline::center(j, knot) - begin_s);
    course.points.push_back(path.point(s));
    course.directions.push_back(path.direction(s));
  }
  return course;
}

std::vector<double> headings(const Course& course, const HeadingConfig& heading, const Sweep& sweep,
                             double knot, double max_yaw_rate) {
  if (heading.mode == HeadingMode::kFixed) {
    return std::vector<double>(course.points.size(), heading.yaw);
  }
  std::vector<double> yaw = yaw_along(course.directions);
  for (std::size_t j = 0; j < yaw.size() && sweep.amplitude > 0.0; ++j) {
    yaw[j] += sweep_at(Spline::center(j, knot), course.begin_s, course.end_s, sweep.amplitude,
                       heading.period_s);
  }
  limit_steps(yaw, max_yaw_rate * knot);
  return yaw;
}

/// The time (s) that remains for moving in a flight of `duration_s`.
double moving_time(double duration_s, double begin_s, const std::string& place) {
  const double moving_s = duration_s - 2.0 * begin_s;
  if (moving_s > 0.0) return moving_s;
  throw InputError(
      place, fmt::format("duration_s {:g} leaves no time to move", duration_s),
      fmt::format("use more than {:.3g} s, the time for hovering, starting and stopping",
                  2.0 * begin_s));
}

PathLimits path_limits(const FlightLimits& limits, double acceleration, HeadingMode mode,
                       const Sweep& sweep) {
  PathLimits path{.max_speed = limits.max_speed,
                  .max_acceleration = acceleration,
                  .max_turn_rate = std::numeric_limits<double>::infinity(),
                  .stop_s = 0.0};
  if (mode != HeadingMode::kFixed) {
    path.max_turn_rate = limits.max_yaw_rate - sweep.rate;
    path.stop_s = pi / limits.max_yaw_rate;  // time for a rotation by 180 degrees
  }
  return path;
}

}  // namespace

SplineFlight::Plan SplineFlight::plan(std::span<const Vector3d> waypoints,
                                      const FlightConfig& config, const std::string& place) {
  check_waypoints(waypoints, place);
  const FlightLimits limits = limits_of(config);
  const double acceleration = usable_acceleration(limits, config.corner_m);
  const double knot = 2.0 * acceleration / limits.max_jerk;
  const Sweep sweep = sweep_of(config.heading, knot, limits.max_yaw_rate, place);
  const PathLimits on_path = path_limits(limits, acceleration, config.heading.mode, sweep);
  const double smoothed_away = 0.5 * acceleration * Spline::kVariance * knot * knot;
  // a control point affects the flight within half a support before and after its instant
  const double begin_s = config.hover_s + Spline::kHalfSupport * knot;

  const bool loops = config.duration_s > 0.0;
  const double moving_s = loops ? moving_time(config.duration_s, begin_s, place) : 0.0;
  const auto line = loops ? repeated_line(waypoints, limits.max_speed * moving_s)
                          : std::vector<Vector3d>(waypoints.begin(), waypoints.end());
  const RoundedPath path = round_corners(line, config.corner_m - smoothed_away);
  const TimeLaw law =
      loops ? law_of_duration(path, on_path, moving_s) : TimeLaw(path, on_path, path.length());
  const double duration_s = loops ? config.duration_s : law.duration() + 2.0 * begin_s;

  const auto intervals = static_cast<std::size_t>(std::ceil(duration_s / knot));
  const Course course = sample(path, law, begin_s, knot, intervals + kDegree);
  const auto yaw = headings(course, config.heading, sweep, knot, limits.max_yaw_rate);
  std::vector<Vector4d> controls(yaw.size());
  for (std::size_t j = 0; j < yaw.size(); ++j) controls[j] << course.points[j], yaw[j];
  return {Spline(controls, knot), from_seconds(duration_s)};
}

SplineFlight::SplineFlight(std::span<const Vector3d> waypoints, const FlightConfig& config,
                           const std::string& place)
    : SplineFlight(plan(waypoints, config, place)) {}

Spline::Place SplineFlight::find(Time t) const {
  return spline_.find(to_seconds(std::clamp(t, Time{0}, duration_)));
}

Motion SplineFlight::at(Time t) const {
  const Spline::Place at = find(t);
  Motion motion =
      motion_of({spline_.derivative<0>(at), spline_.derivative<1>(at), spline_.derivative<2>(at),
                 spline_.derivative<3>(at), spline_.derivative<4>(at)});
  if (t < Time{0} || t > duration_) motion = {.world_from_body = motion.world_from_body};
  return motion;
}

Pose SplineFlight::pose_at(Time t) const {
  const Spline::Place at = find(t);
  const Vector4d value = spline_.derivative<0>(at);
  return make_pose(attitude_of(spline_.derivative<2>(at).head<3>(), value.w()), value.head<3>());
}

}  // namespace lidarena::flight
