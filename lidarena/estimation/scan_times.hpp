// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/base/scan.hpp"

namespace lidarena::estimation {

/// When a scan was taken.
struct ScanTimes {
  Time first{0};       ///< of the earliest point
  Time last{0};        ///< of the latest point
  bool timed = false;  ///< points carry times that differ
  double seconds() const { return to_seconds(last - first); }
};

/// An empty scan counts as lasting `nominal_duration`.
ScanTimes times_of(const Scan& scan, Time nominal_duration);

}  // namespace lidarena::estimation
