// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "lidarena/base/scan.hpp"
#include "lidarena/estimation/imu_buffer.hpp"

namespace lidarena::odometry::arena_lio {

/// A part of a scan in time, and the motion until its end.
struct Slice {
  Scan points;
  std::vector<estimation::ImuInterval> intervals;
};

/// How many slices of equal duration, at most eight, a scan needs so that the noise of the
/// accelerometer (`density`, m/s^2/sqrt(Hz)), integrated twice, moves the position within a slice
/// by less than `max_error` (m, standard deviation).
int slices_needed(const std::vector<estimation::ImuInterval>& intervals, double density,
                  double max_error);

/// The scan, whose last point is at `end`, in `count` slices. The first one has all intervals
/// before it.
std::vector<Slice> sliced(const Scan& scan, Time end,
                          const std::vector<estimation::ImuInterval>& intervals, int count);

}  // namespace lidarena::odometry::arena_lio
