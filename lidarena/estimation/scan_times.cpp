// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/scan_times.hpp"

#include <algorithm>

namespace lidarena::estimation {

ScanTimes times_of(const Scan& scan, Time nominal_duration) {
  ScanTimes times{scan.stamp, scan.stamp + nominal_duration, false};
  if (scan.points.empty()) return times;
  const auto [earliest, latest] =
      std::minmax_element(scan.points.begin(), scan.points.end(),
                          [](const Point& a, const Point& b) { return a.dt_ns < b.dt_ns; });
  times.first = time_of(scan, *earliest);
  times.last = time_of(scan, *latest);
  times.timed = scan.timed && times.first < times.last;
  return times;
}

}  // namespace lidarena::estimation
