// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/coverage.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lidarena/base/angle.hpp"

namespace lidarena::sensor {
namespace {

/// Single-precision directions have errors of 4e-6 deg. This offset puts a ring that lies on a
/// border between cells entirely on one side of it.
constexpr double kNudgeDeg = 1e-5;

int cells(double from_deg, double to_deg, double cell_deg) {
  return std::max(1, static_cast<int>(std::ceil((to_deg - from_deg) / cell_deg - 1e-9)));
}

struct Angles {
  double azimuth_deg, elevation_deg;
};

Angles angles_of(const Eigen::Vector3f& direction) {
  const Eigen::Vector3d d = direction.cast<double>();
  return {std::atan2(d.y(), d.x()) / kDegree,
          std::atan2(d.z(), std::hypot(d.x(), d.y())) / kDegree};
}

}  // namespace

bool contains(const FieldOfView& fov, const Eigen::Vector3f& direction) {
  const Angles angles = angles_of(direction);
  return angles.azimuth_deg >= fov.azimuth_min_deg - kNudgeDeg &&
         angles.azimuth_deg <= fov.azimuth_max_deg + kNudgeDeg &&
         angles.elevation_deg >= fov.elevation_min_deg - kNudgeDeg &&
         angles.elevation_deg <= fov.elevation_max_deg + kNudgeDeg &&
         static_cast<double>(direction.x()) >= std::cos(fov.half_angle_deg * kDegree) - 1e-7;
}

Coverage::Coverage(const FieldOfView& fov, double cell_deg)
    : fov_(fov),
      cell_deg_(cell_deg),
      columns_(cells(fov.azimuth_min_deg, fov.azimuth_max_deg, cell_deg)),
      rows_(cells(fov.elevation_min_deg, fov.elevation_max_deg, cell_deg)),
      lit_(index(0, rows_)) {}

void Coverage::add(const Eigen::Vector3f& direction) {
  const Angles angles = angles_of(direction);
  const double azimuth = angles.azimuth_deg - fov_.azimuth_min_deg + kNudgeDeg;
  const double elevation = angles.elevation_deg - fov_.elevation_min_deg + kNudgeDeg;
  const double width = fov_.azimuth_max_deg - fov_.azimuth_min_deg + 2 * kNudgeDeg;
  const double height = fov_.elevation_max_deg - fov_.elevation_min_deg + 2 * kNudgeDeg;
  if (azimuth < 0.0 || azimuth > width || elevation < 0.0 || elevation > height) return;
  const auto column = static_cast<int>(azimuth / cell_deg_);
  const auto row = static_cast<int>(elevation / cell_deg_);
  lit_[index(std::min(column, columns_ - 1), std::min(row, rows_ - 1))] = true;
}

double Coverage::share() const {
  const double cos_half_angle = std::cos(fov_.half_angle_deg * kDegree);
  double lit = 0.0;
  double all = 0.0;
  for (int row = 0; row < rows_; ++row) {
    const double low = (fov_.elevation_min_deg + row * cell_deg_) * kDegree;
    const double weight = std::sin(low + cell_deg_ * kDegree) - std::sin(low);
    const double cos_elevation = std::cos(low + cell_deg_ * kDegree / 2);
    for (int column = 0; column < columns_; ++column) {
      const double azimuth = (fov_.azimuth_min_deg + (column + 0.5) * cell_deg_) * kDegree;
      if (cos_elevation * std::cos(azimuth) < cos_half_angle) continue;  // outside the cone about x
      all += weight;
      if (lit_[index(column, row)]) lit += weight;
    }
  }
  return all > 0.0 ? lit / all : 0.0;
}

Shots::Shots(const ScanPattern& pattern) : pattern_(pattern) { pattern_.beams(0, beams_); }

void Shots::advance() {
  if (++next_ < beams_.size()) return;
  next_ = 0;
  stamp_ += pattern_.period();
  pattern_.beams(++scan_, beams_);
}

FieldOfView observed_field_of_view(const ScanPattern& pattern, Time end) {
  FieldOfView fov{180.0, -180.0, 90.0, -90.0};
  for (Shots shots(pattern); shots.time() < end; shots.advance()) {
    const Angles angles = angles_of(shots.beam().direction);
    fov.azimuth_min_deg = std::min(fov.azimuth_min_deg, std::floor(angles.azimuth_deg));
    fov.azimuth_max_deg = std::max(fov.azimuth_max_deg, std::ceil(angles.azimuth_deg));
    fov.elevation_min_deg = std::min(fov.elevation_min_deg, std::floor(angles.elevation_deg));
    fov.elevation_max_deg = std::max(fov.elevation_max_deg, std::ceil(angles.elevation_deg));
  }
  return fov;
}

std::vector<double> coverage(const ScanPattern& pattern, const FieldOfView& fov, double cell_deg,
                             std::span<const Time> instants) {
  Coverage grid(fov, cell_deg);
  Shots shots(pattern);
  std::vector<double> shares;
  for (const Time instant : instants) {
    for (; shots.time() < instant; shots.advance()) grid.add(shots.beam().direction);
    shares.push_back(grid.share());
  }
  return shares;
}

}  // namespace lidarena::sensor
