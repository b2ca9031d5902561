// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/heading.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lidarena::flight {
namespace {

// Minimum horizontal part of a unit vector; the heading of steeper directions is undefined.
constexpr double kMinHorizontal = 0.1;

}  // namespace

std::vector<double> yaw_along(std::span<const Eigen::Vector3d> directions) {
  const auto is_level = [](const Eigen::Vector3d& d) {
    return d.head<2>().norm() >= kMinHorizontal;
  };
  const auto first = std::find_if(directions.begin(), directions.end(), is_level);
  double last = first == directions.end() ? 0.0 : std::atan2(first->y(), first->x());
  std::vector<double> yaw;
  yaw.reserve(directions.size());
  for (const Eigen::Vector3d& d : directions) {
    if (is_level(d)) {
      last += std::remainder(std::atan2(d.y(), d.x()) - last, 2.0 * std::numbers::pi);
    }
    yaw.push_back(last);
  }
  return yaw;
}

double sweep_at(double t, double begin_s, double end_s, double amplitude, double period_s) {
  const double fade = std::clamp(std::min(t - begin_s, end_s - t) / period_s, 0.0, 1.0);
  return fade * amplitude * std::sin(2.0 * std::numbers::pi * (t - begin_s) / period_s);
}

void limit_steps(std::span<double> yaw, double step) {
  for (std::size_t i = 1; i < yaw.size(); ++i) {
    yaw[i] = yaw[i - 1] + std::clamp(yaw[i] - yaw[i - 1], -step, step);
  }
}

}  // namespace lidarena::flight
