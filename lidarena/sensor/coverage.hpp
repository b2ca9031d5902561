// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "lidarena/base/time.hpp"
#include "lidarena/sensor/field_of_view.hpp"
#include "lidarena/sensor/scan_pattern.hpp"

namespace lidarena::sensor {

/// Whether the direction is within the field of view, edges included.
bool contains(const FieldOfView& fov, const Eigen::Vector3f& direction);

/// Grid over a field of view that records which cells were hit by a ray. Cells are squares in
/// azimuth and elevation, in rows from the minimum azimuth and elevation on; a cell belongs to the
/// field of view if its center does.
class Coverage {
 public:
  /// `cell_deg` > 0; the box of `fov` should be a whole number of cells wide and high.
  Coverage(const FieldOfView& fov, double cell_deg);

  void add(const Eigen::Vector3f& direction);

  /// Solid angle of the cells hit, divided by that of all cells of the field of view, 0..1.
  double share() const;

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  bool lit(int column, int row) const { return lit_[index(column, row)]; }

 private:
  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(column);
  }

  FieldOfView fov_;
  double cell_deg_;
  int columns_;
  int rows_;
  std::vector<bool> lit_;
};

/// Iterates over the shots of a pattern from the sensor's start on.
class Shots {
 public:
  /// Keeps a reference to `pattern`.
  explicit Shots(const ScanPattern& pattern);

  /// The current shot, and its time since the start.
  const Beam& beam() const { return beams_[next_]; }
  Time time() const { return stamp_ + Time{beam().dt_ns}; }
  void advance();

 private:
  const ScanPattern& pattern_;
  std::vector<Beam> beams_;  ///< of the current scan
  std::uint64_t scan_ = 0;
  std::size_t next_ = 0;
  Time stamp_{0};
};

/// Smallest box with edges at whole degrees that contains all shots before `end`.
FieldOfView observed_field_of_view(const ScanPattern& pattern, Time end);

/// Share of the field of view hit before each of the `instants` (ascending, counted from the
/// start).
std::vector<double> coverage(const ScanPattern& pattern, const FieldOfView& fov, double cell_deg,
                             std::span<const Time> instants);

}  // namespace lidarena::sensor
