// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "lidarena/base/config.hpp"
#include "lidarena/sensor/scan_pattern.hpp"

namespace lidarena::sensor {

/// One laser of a spinning head. Angles and origin are given in the head's frame, which rotates
/// with the head: x in its viewing direction, z up.
struct HeadBeam {
  double elevation_deg = std::numeric_limits<double>::quiet_NaN();  ///< must be given
  double azimuth_offset_deg = 0.0;
  double dt_us = 0.0;
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("elevation_deg", self.elevation_deg, "deg", "positive upwards", between(-90, 90));
    v("azimuth_offset_deg", self.azimuth_offset_deg, "deg",
      "from the head's viewing direction, counterclockwise seen from above", between(-180, 180));
    v("dt_us", self.dt_us, "us", "firing time after the start of its column", at_least(0));
    v("origin_m", self.origin_m, "m", "x y z of the point where the beam starts");
  }
};

/// The lasers of a spinning head. All of them fire once in each column; ring is the index in the
/// list.
struct SpinningHead {
  bool clockwise = true;
  double start_azimuth_deg = 0.0;
  double column_period_us = 0.0;
  std::vector<HeadBeam> beams;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("clockwise", self.clockwise, "", "sense of rotation of the head, seen from above");
    v("start_azimuth_deg", self.start_azimuth_deg, "deg",
      "azimuth of the head at the start of a scan, counterclockwise from x", between(-360, 360));
    v("column_period_us", self.column_period_us, "us",
      "time between columns; 0 = one revolution divided by the number of columns", at_least(0));
    v("beams", self.beams, "", "the lasers in order of ring");
  }
};

/// Reads a YAML file with the keys above. Throws InputError naming file and line for an unknown
/// key, a number that is not finite or out of range, a beam without elevation_deg, and a table
/// without beams.
SpinningHead load_spinning_head(const std::filesystem::path& file);

/// A head that rotates once per scan and fires the lasers of its table in each of `columns`
/// columns. The head keeps rotating while a column is fired: each beam is cast at the head's
/// azimuth at its own instant. With a column period, a gap may remain between the last column and
/// the next scan.
class SpinningHeadPattern : public ScanPattern {
 public:
  /// Throws InputError (place `name`) if there are no columns or beams, a beam fires after the end
  /// of its column, or the columns do not fit into a revolution.
  SpinningHeadPattern(const SpinningHead& table, int columns, double rate_hz,
                      const std::string& name);

  Time period() const override { return period_; }
  std::size_t beams_per_scan() const override { return beams_.size(); }
  std::uint64_t repeats_after() const override { return 1; }
  /// The same beams in every scan.
  void beams(std::uint64_t index, std::vector<Beam>& out) const override;

 private:
  Time period_;
  std::vector<Beam> beams_;
};

}  // namespace lidarena::sensor
