// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/scan.hpp"
#include "lidarena/base/se3.hpp"
#include "lidarena/base/trajectory.hpp"
#include "lidarena/estimation/elastic_motion.hpp"
#include "lidarena/estimation/scan_times.hpp"

namespace lidarena::estimation {

/// A point of a scan and its instant within the scan.
struct TimedPoint {
  Eigen::Vector3f position;  ///< m, lidar frame at its own instant
  float alpha;               ///< 0 the scan's first instant, 1 its last
};

/// Points nearer than `min_m` or as far as `max_m` are not used.
struct RangeGate {
  double min_m = 0.0;
  double max_m = 0.0;
};

/// The scan's finite points within the range gate. In a `rigid` scan all have alpha 1, as if it was
/// taken at its last instant.
std::vector<TimedPoint> timed_points(const Scan& scan, const ScanTimes& times, bool rigid,
                                     const RangeGate& gate);

/// World positions (m) of points of a scan with this motion.
std::vector<Eigen::Vector3f> placed(const ElasticMotion& motion, std::span<const TimedPoint> points,
                                    const Parallel& parallel);

/// The motion of a frame that is at `known` and has a constant `twist` (m/s and rad/s, in the
/// moving frame), within `times`, in `segments` of equal duration.
ElasticMotion constant_twist_motion(const StampedPose& known, const se3::Vector6& twist,
                                    const ScanTimes& times, int segments);

/// The same motion, seen from the frame that `by` transforms to.
ElasticMotion moved(const Pose& by, ElasticMotion motion);

/// Poses of the body at the knots of a motion of the lidar. World: the body's frame at the pose at
/// which the lidar's motion is the identity.
std::vector<StampedPose> body_poses(const ElasticMotion& motion, const ScanTimes& times,
                                    const Pose& body_from_lidar);

}  // namespace lidarena::estimation
