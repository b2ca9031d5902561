// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/scan.hpp"
#include "lidarena/base/se3.hpp"
#include "lidarena/estimation/scan_times.hpp"
#include "lidarena/map/voxel_filter.hpp"
#include "lidarena/odometry/kiss_icp/config.hpp"

namespace lidarena::odometry::kiss_icp {

/// Instant of the scan that its pose belongs to.
Time pose_time(const estimation::ScanTimes& times, PoseInstant instant);

/// The scan cut into `count` parts of equal duration, in order of time, without empty parts. A scan
/// without times, or too short to cut, is returned whole.
std::vector<Scan> sliced(const Scan& scan, int count);

/// Twist per second for de-skewing the scan: `motion` divided by `motion_seconds` or, as in the
/// published program, by the duration of this scan (paper, eq. 2).
se3::Vector6 twist_within(const estimation::ScanTimes& times, const Pose& motion,
                          double motion_seconds, const Config& config);

/// Points (m) of a scan, each in the lidar's frame at its own instant, or all at the pose's
/// instant.
struct TimedPoints {
  std::vector<Eigen::Vector3f> positions;
  std::vector<float> seconds;  ///< instants relative to the pose's (mostly < 0); empty: all at it

  bool deskewed() const { return seconds.empty(); }
  std::size_t size() const { return positions.size(); }
};

/// The scan's points within the range gate: de-skewed by `twist_per_second` or, if the scan's own
/// motion is estimated later, at their own instants.
TimedPoints preprocess(const Scan& scan, const estimation::ScanTimes& times,
                       const se3::Vector6& twist_per_second, const Config& config,
                       const Parallel& parallel);

/// The first point of each voxel, see lidarena::thin.
TimedPoints thin(const TimedPoints& points, double voxel_size, const map::Thinning& thinning);

/// The points in the lidar's frame at the pose's instant; the lidar moved with `twist_per_second`.
std::vector<Eigen::Vector3f> deskewed(const TimedPoints& points,
                                      const se3::Vector6& twist_per_second,
                                      const Parallel& parallel);

}  // namespace lidarena::odometry::kiss_icp
