// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/echoes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lidarena::sensor {

std::vector<Eigen::Vector2d> sub_ray_offsets(int count) {
  std::vector<Eigen::Vector2d> offsets;
  for (int i = 0; i < count; ++i) {
    // The share of a two-dimensional Gaussian within radius r is 1 - exp(-r^2 / 2).
    const double radius = std::sqrt(-2.0 * std::log1p(-(i + 0.5) / count));
    offsets.emplace_back(radius * std::cos(i * kGoldenAngle), radius * std::sin(i * kGoldenAngle));
  }
  return offsets;
}

double glare_angle(double half_angle, double u) {
  const double rest = 1.0 - u;
  return half_angle * std::sqrt((1.0 / (rest * rest) - 1.0) / 3.0);
}

Eigen::Vector3d deflected(const Eigen::Vector3d& axis, const Eigen::Vector2d& angles) {
  Eigen::Vector3d left = Eigen::Vector3d::UnitZ().cross(axis);
  const double length = left.norm();
  // For a vertical axis "left" is undefined: take y.
  left = length > 1e-6 ? Eigen::Vector3d(left / length) : Eigen::Vector3d::UnitY();
  return (axis + angles.x() * left + angles.y() * axis.cross(left)).normalized();
}

Eigen::Vector3f slightly_deflected(const Eigen::Vector3f& axis, float left, float up) {
  const float length = std::sqrt(axis.x() * axis.x() + axis.y() * axis.y());
  // The same direction "left" as in deflected().
  const float x = length > 1e-6F ? -axis.y() / length : 0.0F;
  const float y = length > 1e-6F ? axis.x() / length : 1.0F;
  const Eigen::Vector3f to_left(x, y, 0.0F);
  // The three directions are orthogonal: the sum has the length sqrt(1 + left^2 + up^2).
  const float shorten = 1.0F - 0.5F * (left * left + up * up);
  return shorten * (axis + left * to_left + up * axis.cross(to_left));
}

void merge_echoes(std::span<Echo> parts, double pulse_length, std::vector<Echo>& echoes) {
  std::ranges::sort(parts, [](const Echo& a, const Echo& b) {
    return a.range < b.range || (a.range == b.range && a.sub_ray < b.sub_ray);
  });
  echoes.clear();
  double strongest = 0.0;
  double last = 0.0;
  double weighted_range = 0.0;
  for (const Echo& part : parts) {
    if (echoes.empty() || part.range - last > pulse_length) {
      echoes.push_back({0.0, 0.0, 0.0, part.sub_ray});
      strongest = weighted_range = 0.0;
    }
    Echo& echo = echoes.back();
    last = part.range;
    echo.energy += part.energy;
    echo.signal += part.signal;
    weighted_range += part.signal * part.range;
    // Parts from black surfaces have no signal: take the range of the last one.
    echo.range = echo.signal > 0.0 ? weighted_range / echo.signal : part.range;
    if (part.signal > strongest) {
      strongest = part.signal;
      echo.sub_ray = part.sub_ray;
    }
  }
}

void choose_echoes(const ReturnConfig& config, std::vector<Echo>& echoes) {
  if (echoes.size() < 2) return;
  if (config.choice == EchoChoice::kLast) std::ranges::reverse(echoes);
  if (config.choice == EchoChoice::kStrongest) {
    std::ranges::stable_sort(echoes, std::ranges::greater{}, &Echo::signal);
  }
  if (echoes.size() > static_cast<std::size_t>(config.count)) {
    echoes.erase(echoes.begin() + config.count, echoes.end());
  }
}

}  // namespace lidarena::sensor
