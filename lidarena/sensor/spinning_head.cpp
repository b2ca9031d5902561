// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/spinning_head.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "lidarena/base/angle.hpp"
#include "lidarena/base/error.hpp"

namespace lidarena::sensor {
namespace {

constexpr int kMaxColumns = 100'000;  // fifty times any sensor's; limits memory if mistyped

void check(const SpinningHead& table, int columns, double column_us, double revolution_us,
           const std::string& name) {
  if (table.beams.empty()) throw InputError(name, "the beam table has no beams");
  if (columns < 1) throw InputError(name, "columns is not positive", "set columns");
  if (columns > kMaxColumns) throw InputError(name, "there are too many columns per revolution");
  for (std::size_t ring = 0; ring < table.beams.size(); ++ring) {
    const std::string beam = "beam " + std::to_string(ring) + " of the table ";
    if (std::isnan(table.beams[ring].elevation_deg)) {
      throw InputError(name, beam + "has no elevation_deg");
    }
    if (!(table.beams[ring].dt_us < column_us)) {
      throw InputError(name, beam + "fires after its column ends",
                       "keep dt_us below the column period");
    }
  }
  if (column_us * columns > revolution_us * (1.0 + 1e-9)) {
    throw InputError(name, "the columns take longer than a revolution",
                     "lower columns, column_period_us or rate_hz");
  }
}

/// Rings in the order in which they fire.
std::vector<std::size_t> firing_order(const SpinningHead& table) {
  std::vector<std::size_t> rings(table.beams.size());
  std::iota(rings.begin(), rings.end(), std::size_t{0});
  std::stable_sort(rings.begin(), rings.end(), [&](std::size_t a, std::size_t b) {
    return table.beams[a].dt_us < table.beams[b].dt_us;
  });
  return rings;
}

/// The beam while the head's azimuth is `head`, rad.
Beam beam_at(const HeadBeam& row, double head) {
  const double azimuth = head + row.azimuth_offset_deg * kDegree;
  const double elevation = row.elevation_deg * kDegree;
  Beam beam;
  beam.direction = Eigen::Vector3d(std::cos(azimuth) * std::cos(elevation),
                                   std::sin(azimuth) * std::cos(elevation), std::sin(elevation))
                       .cast<float>();
  beam.origin = (Eigen::AngleAxisd(head, Eigen::Vector3d::UnitZ()) * row.origin_m).cast<float>();
  return beam;
}

}  // namespace

SpinningHeadPattern::SpinningHeadPattern(const SpinningHead& table, int columns, double rate_hz,
                                         const std::string& name)
    : period_(from_seconds(1.0 / rate_hz)) {
  const double revolution_us = 1e6 / rate_hz;
  const double column_us =
      table.column_period_us > 0.0 ? table.column_period_us : revolution_us / std::max(columns, 1);
  check(table, columns, column_us, revolution_us, name);
  const double sign = table.clockwise ? -1.0 : 1.0;
  const std::vector<std::size_t> rings = firing_order(table);
  beams_.reserve(static_cast<std::size_t>(columns) * rings.size());
  for (int column = 0; column < columns; ++column) {
    for (const std::size_t ring : rings) {
      const double us = column * column_us + table.beams[ring].dt_us;
      const double angle = 2.0 * std::numbers::pi * us / revolution_us;
      Beam beam = beam_at(table.beams[ring], table.start_azimuth_deg * kDegree + sign * angle);
      beam.dt_ns = static_cast<std::int32_t>(std::llround(1e3 * us));
      beam.ring = static_cast<std::uint16_t>(ring);
      beams_.push_back(beam);
    }
  }
}

void SpinningHeadPattern::beams(std::uint64_t, std::vector<Beam>& out) const { out = beams_; }

}  // namespace lidarena::sensor
