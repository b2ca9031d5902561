// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "lidarena/sensor/scan_pattern.hpp"

namespace lidarena::sensor {

/// A line that maps elevations, deg: elevation' = scale * elevation + shift.
struct ElevationMap {
  double scale = 1.0;
  double shift = 0.0;  ///< deg

  bool is_identity() const { return scale == 1.0 && shift == 0.0; }
  double operator()(double elevation_deg) const { return scale * elevation_deg + shift; }
};

/// A pattern whose shots keep their times, azimuths, rings and origins, while their elevations are
/// mapped; if it is `repetitive`, each scan has the shots of the first one.
class ShapedPattern : public ScanPattern {
 public:
  ShapedPattern(std::unique_ptr<ScanPattern> pattern, ElevationMap map, bool repetitive)
      : pattern_(std::move(pattern)), map_(map), repetitive_(repetitive) {}

  Time period() const override { return pattern_->period(); }
  std::size_t beams_per_scan() const override { return pattern_->beams_per_scan(); }
  std::uint64_t repeats_after() const override {
    return repetitive_ ? 1 : pattern_->repeats_after();
  }
  void beams(std::uint64_t index, std::vector<Beam>& out) const override;

 private:
  std::unique_ptr<ScanPattern> pattern_;
  ElevationMap map_;
  bool repetitive_;
};

}  // namespace lidarena::sensor
