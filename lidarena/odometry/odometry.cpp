// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/odometry.hpp"

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
  }
  return "unknown";
}

}  // namespace lidarena::odometry
