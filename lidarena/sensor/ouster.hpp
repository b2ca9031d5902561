// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "lidarena/sensor/scan_pattern.hpp"

namespace lidarena::sensor {

/// Viewing direction of one row of an Ouster, relative to the head.
struct OusterRow {
  double altitude;        ///< rad, up
  double azimuth_offset;  ///< rad, clockwise seen from above (as the head rotates)
};

/// Row 0 (top) .. 127 of an OS0-128: four pixel columns behind an f-theta lens with a cubic term,
/// fitted to one unit's calibration (0.02 deg rms in altitude, 0.03 deg in azimuth).
OusterRow os0_128_row(int row);

/// OS0-128: the head rotates clockwise once per scan and fires all 128 rows at each of `columns`
/// azimuths. The lidar frame is the manufacturer's: x points to the connector, the direction of
/// column 0. Beams start on a circle of 27.67 mm radius about the axis; ring is the row.
class OusterOs0Pattern : public ScanPattern {
 public:
  static constexpr int kRows = 128;
  static constexpr double kBeamOriginRadius = 0.02767;  ///< m, units up to revision 6

  /// Modes: 512, 1024 or 2048 columns at 10 Hz; 512 or 1024 at 20 Hz. Throws InputError (place
  /// `name`) for others. `fired`: columns in which it fires instead, which no product does; 0 = as
  /// many.
  OusterOs0Pattern(int columns, double rate_hz, const std::string& name, int fired = 0);

  Time period() const override { return period_; }
  std::size_t beams_per_scan() const override { return beams_.size(); }
  /// The same beams in every scan.
  void beams(std::uint64_t index, std::vector<Beam>& out) const override;
  std::uint64_t repeats_after() const override { return 1; }

 private:
  Time period_;
  std::vector<Beam> beams_;  ///< column by column
};

}  // namespace lidarena::sensor
