// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "lidarena/sensor/scan_pattern.hpp"

namespace lidarena::sensor {

/// Reads the unit directions of a table in Livox's format: a first line that names three columns
/// with units, Time/s,Azimuth/deg,Zenith/deg, then rows of numbers. The azimuth counts from x
/// towards y, the zenith angle from z; also read are columns in another order, radians, and
/// elevations (from the xy plane). Rows are taken as evenly spaced in time; the column of times
/// must hold numbers but is not used. Throws InputError naming file and line if the header does not
/// state the meaning and unit of both angles, a row does not have three numbers, a number is not
/// finite or out of range, or the file is missing or has no rows.
std::vector<Eigen::Vector3f> read_livox_csv(const std::filesystem::path& file);

/// Fires the rays of a table at `row_rate_hz` rows per second and starts over at its end; ring is
/// the index of the row in the table modulo `lines`.
class RayTablePattern : public ScanPattern {
 public:
  /// Throws InputError (place `name`) if a scan would not hold a whole number of rows, or `rays` is
  /// empty.
  RayTablePattern(std::vector<Eigen::Vector3f> rays, double row_rate_hz, int lines, double rate_hz,
                  const std::string& name);

  Time period() const override { return period_; }
  std::size_t beams_per_scan() const override { return rows_per_scan_; }
  std::uint64_t repeats_after() const override;
  void beams(std::uint64_t index, std::vector<Beam>& out) const override;

 private:
  std::vector<Eigen::Vector3f> rays_;
  double row_rate_hz_;
  std::uint64_t lines_;
  Time period_;
  std::size_t rows_per_scan_;
};

}  // namespace lidarena::sensor
