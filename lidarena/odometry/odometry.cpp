// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/odometry.hpp"

#include <algorithm>

namespace lidarena::odometry {

const char* to_string(ScanStatus status) {
  switch (status) {
    case ScanStatus::kTracked:
      return "tracked";
    case ScanStatus::kInitializing:
      return "initializing";
    case ScanStatus::kDegenerate:
      return "degenerate";
    case ScanStatus::kTooFewPoints:
      return "too_few_points";
    case ScanStatus::kDiverged:
      return "diverged";
    case ScanStatus::kRefused:
      return "refused";
  }
  return "unknown";
}

std::optional<double> ScanResult::detail(std::string_view name) const {
  const auto found = std::ranges::find(details, name, &ScanDetails::value_type::first);
  return found == details.end() ? std::nullopt : std::optional(found->second);
}

ScanResult Odometry::register_scan(const Scan& scan) {
  const Time end = end_of(scan);
  if (last_begin_ && (scan.stamp <= *last_begin_ || end <= *last_end_)) {
    ++scans_refused_;
    return {.estimate = last_estimate_, .status = ScanStatus::kRefused};
  }
  last_begin_ = scan.stamp;
  last_end_ = end;
  ScanResult result = track(scan);
  last_estimate_ = result.estimate;
  return result;
}

}  // namespace lidarena::odometry
