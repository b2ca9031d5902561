// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lidarena::flight {

FlightFigures figures_of(const Flight& flight) {
  constexpr Time kStep = std::chrono::milliseconds(1);
  constexpr double kLivelySpeed = 2.0;                    // m/s
  constexpr double kLivelyRate = 0.5 * std::numbers::pi;  // rad/s
  FlightFigures figures;
  figures.duration_s = to_seconds(flight.duration());
  Eigen::Vector3d last = flight.pose_at(Time{0}).translation();
  double lively = 0.0, count = 0.0;
  for (Time t{0}; t <= flight.duration(); t += kStep) {
    const Motion m = flight.at(t);
    const auto raise = [](double& maximum, double value) { maximum = std::max(maximum, value); };
    raise(figures.max_speed, m.velocity_world.norm());
    raise(figures.max_acceleration, m.acceleration_world.norm());
    const Eigen::Vector3d z = m.world_from_body.linear().col(2);
    raise(figures.max_tilt, std::atan2(z.head<2>().norm(), z.z()));
    raise(figures.max_angular_rate, m.angular_rate_body.norm());
    raise(figures.max_angular_acceleration, m.angular_acceleration_body.norm());
    figures.length_m += (m.world_from_body.translation() - last).norm();
    last = m.world_from_body.translation();
    count += 1.0;
    const bool is_lively =
        m.velocity_world.norm() > kLivelySpeed || m.angular_rate_body.norm() > kLivelyRate;
    if (is_lively) lively += 1.0;
  }
  figures.fast_share = lively / count;
  return figures;
}

std::string describe(const FlightFigures& f) {
  return fmt::format(
      "{:.1f} s, {:.1f} m, up to {:.2f} m/s, {:.2f} m/s^2, tilt {:.0f} deg, {:.2f} rad/s; "
      "{:.0f} % of the time above 2 m/s or 90 deg/s",
      f.duration_s, f.length_m, f.max_speed, f.max_acceleration,
      f.max_tilt * 180.0 / std::numbers::pi, f.max_angular_rate, 100.0 * f.fast_share);
}

}  // namespace lidarena::flight
