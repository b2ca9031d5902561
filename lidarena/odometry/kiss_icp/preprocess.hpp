// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/scan.hpp"
#include "lidarena/base/se3.hpp"
#include "lidarena/odometry/kiss_icp/config.hpp"

namespace lidarena::kiss_icp {

/// When a scan was taken.
struct ScanTimes {
  Time first{0};       ///< of the earliest point
  Time last{0};        ///< of the latest point
  Time reference{0};   ///< instant of the pose
  bool timed = false;  ///< points carry times that tell them apart
  double seconds() const { return to_seconds(last - first); }
};

/// An empty scan counts as lasting `usual_duration`, so that its pose's instant lies in the row.
ScanTimes times_of(const Scan& scan, Time usual_duration, PoseInstant instant);

/// Motion that the scan is de-skewed with, per second: `motion` took `motion_seconds`, or, as the
/// public program has it, exactly as long as this scan (paper, eq. 2).
se3::Vector6 twist_within(const ScanTimes& times, const Pose& motion, double motion_seconds,
                          const Config& config);

/// The scan's points within the range gate, de-skewed to `times.reference`, lidar frame, m.
std::vector<Eigen::Vector3f> preprocess(const Scan& scan, const ScanTimes& times,
                                        const se3::Vector6& twist_per_second, const Config& config,
                                        const Parallel& parallel);

}  // namespace lidarena::kiss_icp
