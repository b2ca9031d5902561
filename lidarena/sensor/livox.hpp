// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "lidarena/sensor/optics.hpp"
#include "lidarena/sensor/scan_pattern.hpp"

namespace lidarena::sensor {

/// Angle of a rotor at the firing of group k, with m = modulation_step_deg:
///   phase_deg + step_deg * (k + sample_offset)
///   + modulation_rad * (sin(2 m (k + 1/2)) * m / sin m + m)
/// The last term is a sinusoidal speed modulation, summed sample by sample.
struct Rotor {
  double phase_deg;
  double step_deg;  ///< per group
  double sample_offset;
  double modulation_rad = 0.0;
  double modulation_step_deg = 0.0;  ///< per group; the modulation has twice this frequency
};

/// Optical design of a Livox: fixed emitters that fire together, and optical surfaces on rotors.
struct LivoxModel {
  double row_rate_hz;                     ///< rows (shots) per second
  std::vector<Eigen::Vector3d> emitters;  ///< unit; row r: emitter r % size of group r / size
  std::vector<Rotor> rotors;
  std::vector<Surface> surfaces;
  double glass_index;
  /// Groups fired in the time of one group of the design: above 1, the lasers fire more often than
  /// those of the product, while the rotors turn as fast.
  double shots_factor = 1.0;
  std::uint64_t repeat_groups;  ///< number of groups after which all rotor angles repeat exactly
  Eigen::Matrix3d lidar_from_chain;  ///< optical axis of the chain is +z
};

/// Mid-360: two rotors, four refractions, one mirror; 200,000 rows/s, repeats after 12 s.
LivoxModel livox_mid360();
/// Mid-40 and Mid-70: two wedges; 100,000 rows/s, repeat after 30 s.
LivoxModel livox_mid40();
LivoxModel livox_mid70();
/// Avia, non-repetitive: six emitters, three wedges; 240,000 rows/s. Approximate: angles and rates
/// are taken from HELIOS++; they give the data sheet's field of view, 70.4 x 77.2 deg, to 0.2 deg;
/// not compared with the manufacturer's table.
LivoxModel livox_avia();

/// Number of rows of a scan. Throws InputError (place `name`) if it is not a multiple of
/// `emitters`.
std::size_t rows_per_scan(double row_rate_hz, double rate_hz, std::size_t emitters,
                          const std::string& name);
/// Time of row `row` after the start of its scan, rounded to ns.
std::int32_t row_dt_ns(std::size_t row, double row_rate_hz);

/// Unit direction of row `row`, counted from the sensor's start; lidar frame (x forward, y left,
/// z up).
Eigen::Vector3d livox_direction(const LivoxModel& model, std::uint64_t row);

/// Scan m covers rows m n .. m n + n - 1 with n = row rate / scan rate; rows are one row period
/// apart, as the driver stamps them; ring is the emitter.
class LivoxPattern : public ScanPattern {
 public:
  /// Throws InputError (place `name`) if a scan at `rate_hz` does not hold a whole number of
  /// groups.
  LivoxPattern(LivoxModel model, double rate_hz, const std::string& name);

  Time period() const override { return period_; }
  std::size_t beams_per_scan() const override { return rows_per_scan_; }
  void beams(std::uint64_t index, std::vector<Beam>& out) const override;
  std::uint64_t repeats_after() const override;

 private:
  LivoxModel model_;
  Time period_;
  std::size_t rows_per_scan_;
};

}  // namespace lidarena::sensor
