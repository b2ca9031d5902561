// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/ouster.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include "lidarena/base/error.hpp"

namespace lidarena::sensor {
namespace {

constexpr double kRowPitch = 0.012314;     // rad behind the lens, between neighboring rows
constexpr double kColumnPitch = 0.048775;  // rad, half the step between pixel columns
constexpr double kCubicTerm = 0.04265;     // of the f-theta lens

bool is_mode(int columns, double rate_hz) {
  if (rate_hz == 10.0) return columns == 512 || columns == 1024 || columns == 2048;
  return rate_hz == 20.0 && (columns == 512 || columns == 1024);
}

/// The manufacturer's range-to-point formula: with the range r measured from the axis and the beam
/// origin at radius n, x = (r - n) cos(e - a) cos f + n cos e, and so on.
Beam make_beam(const OusterRow& row, double encoder) {
  const double azimuth = encoder - row.azimuth_offset;
  Beam beam;
  beam.direction =
      Eigen::Vector3d(std::cos(azimuth) * std::cos(row.altitude),
                      std::sin(azimuth) * std::cos(row.altitude), std::sin(row.altitude))
          .cast<float>();
  beam.origin = (OusterOs0Pattern::kBeamOriginRadius *
                 Eigen::Vector3d(std::cos(encoder), std::sin(encoder), 0.0))
                    .cast<float>();
  return beam;
}

}  // namespace

OusterRow os0_128_row(int row) {
  constexpr std::array<int, 4> kPixelColumn{3, 1, -1, -3};
  const double y = (63.5 - row) * kRowPitch;
  const double x = kPixelColumn[static_cast<std::size_t>(row % 4)] * kColumnPitch;
  const double r = std::hypot(x, y);
  const double angle = r * (1.0 + kCubicTerm * r * r);
  const Eigen::Vector3d direction(std::cos(angle), std::sin(angle) * x / r,
                                  std::sin(angle) * y / r);
  return {std::asin(direction.z()), std::atan2(direction.y(), direction.x())};
}

OusterOs0Pattern::OusterOs0Pattern(int columns, double rate_hz, const std::string& name, int fired)
    : period_(from_seconds(1.0 / rate_hz)) {
  if (!is_mode(columns, rate_hz)) {
    throw InputError(name,
                     std::to_string(columns) + " columns at this rate_hz are not a mode of the OS0",
                     "use 512, 1024 or 2048 columns at 10 Hz, or 512 or 1024 at 20 Hz");
  }
  if (fired > 0) columns = fired;
  beams_.reserve(static_cast<std::size_t>(columns * kRows));
  for (int column = 0; column < columns; ++column) {
    const double revolutions = static_cast<double>(column) / columns;
    const auto dt =
        static_cast<std::int32_t>(std::llround(revolutions * static_cast<double>(period_.count())));
    for (int row = 0; row < kRows; ++row) {
      Beam beam = make_beam(os0_128_row(row), 2.0 * std::numbers::pi * (1.0 - revolutions));
      beam.dt_ns = dt;
      beam.ring = static_cast<std::uint16_t>(row);
      beams_.push_back(beam);
    }
  }
}

void OusterOs0Pattern::beams(std::uint64_t, std::vector<Beam>& out) const { out = beams_; }

}  // namespace lidarena::sensor
