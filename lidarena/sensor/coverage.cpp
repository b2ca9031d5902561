// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/coverage.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lidarena {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

int cells(double from_deg, double to_deg, double cell_deg) {
  return static_cast<int>(std::ceil((to_deg - from_deg) / cell_deg - 1e-9));
}

}  // namespace

Coverage::Coverage(const FieldOfView& fov, double cell_deg)
    : fov_(fov),
      cell_deg_(cell_deg),
      columns_(cells(fov.azimuth_min_deg, fov.azimuth_max_deg, cell_deg)),
      rows_(cells(fov.elevation_min_deg, fov.elevation_max_deg, cell_deg)),
      lit_(index(0, rows_)) {}

void Coverage::add(const Eigen::Vector3f& direction) {
  const Eigen::Vector3d d = direction.cast<double>();
  const double azimuth = std::atan2(d.y(), d.x()) / kDegree;
  const double elevation = std::atan2(d.z(), std::hypot(d.x(), d.y())) / kDegree;
  if (azimuth < fov_.azimuth_min_deg || azimuth > fov_.azimuth_max_deg) return;
  if (elevation < fov_.elevation_min_deg || elevation > fov_.elevation_max_deg) return;
  const auto column = static_cast<int>((azimuth - fov_.azimuth_min_deg) / cell_deg_);
  const auto row = static_cast<int>((elevation - fov_.elevation_min_deg) / cell_deg_);
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
      if (cos_elevation * std::cos(azimuth) < cos_half_angle) continue;  // of the angle to x
      all += weight;
      if (lit_[index(column, row)]) lit += weight;
    }
  }
  return lit / all;
}

Shots::Shots(const ScanPattern& pattern) : pattern_(pattern) { pattern_.beams(0, beams_); }

void Shots::advance() {
  if (++next_ < beams_.size()) return;
  next_ = 0;
  stamp_ += pattern_.period();
  pattern_.beams(++scan_, beams_);
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

}  // namespace lidarena
