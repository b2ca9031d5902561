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

namespace lidarena {

/// One laser of a spinning head. Angles and origin are given in the head's frame: x where the head
/// looks, z up, so they turn with it.
struct HeadBeam {
  double elevation_deg = std::numeric_limits<double>::quiet_NaN();  ///< must be given
  double azimuth_offset_deg = 0.0;
  double dt_us = 0.0;
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("elevation_deg", self.elevation_deg, "deg", "up", between(-90, 90));
    v("azimuth_offset_deg", self.azimuth_offset_deg, "deg",
      "from where the head looks, counterclockwise seen from above", between(-180, 180));
    v("dt_us", self.dt_us, "us", "when it fires after its column begins", at_least(0));
    v("origin_m", self.origin_m, "m", "x y z of where the beam starts");
  }
};

/// The lasers of a spinning head that fires all of them once in each column; ring is the place in
/// the list.
struct SpinningHead {
  bool clockwise = true;
  double start_azimuth_deg = 0.0;
  double column_period_us = 0.0;
  std::vector<HeadBeam> beams;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("clockwise", self.clockwise, "", "how the head turns, seen from above");
    v("start_azimuth_deg", self.start_azimuth_deg, "deg",
      "where the head looks when a scan begins, counterclockwise from x", between(-360, 360));
    v("column_period_us", self.column_period_us, "us",
      "from one column to the next; 0 = a turn cut evenly", at_least(0));
    v("beams", self.beams, "", "the lasers, ring by ring");
  }
};

/// Reads a YAML file of the keys above. Throws InputError naming file and line for a key that is
/// unknown, a number that is not finite or out of range, a beam without elevation_deg, and a table
/// without beams.
SpinningHead load_spinning_head(const std::filesystem::path& file);

/// A head that turns once a scan and fires the lasers of its table in each of `columns` columns.
/// The head goes on turning while a column is fired: each beam looks where the head is at its own
/// instant. With a column period the scan's last columns leave a gap before the next scan.
class SpinningHeadPattern : public ScanPattern {
 public:
  /// Throws InputError (place `name`) when there are no columns or beams, a beam fires after its
  /// column, or the columns do not fit into a turn.
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

}  // namespace lidarena
