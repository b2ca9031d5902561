// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/kiss_icp/preprocess.hpp"

#include <algorithm>

#include "lidarena/estimation/deskew.hpp"

namespace lidarena::kiss_icp {

ScanTimes times_of(const Scan& scan, Time usual_duration, PoseInstant instant) {
  ScanTimes times{scan.stamp, scan.stamp + usual_duration, {}, false};
  if (!scan.points.empty()) {
    const auto [earliest, latest] =
        std::minmax_element(scan.points.begin(), scan.points.end(),
                            [](const Point& a, const Point& b) { return a.dt_ns < b.dt_ns; });
    times.first = time_of(scan, *earliest);
    times.last = time_of(scan, *latest);
    times.timed = scan.timed && times.first < times.last;
  }
  times.reference =
      instant == PoseInstant::kScanEnd ? times.last : times.first + (times.last - times.first) / 2;
  return times;
}

se3::Vector6 twist_within(const ScanTimes& times, const Pose& motion, double motion_seconds,
                          const Config& config) {
  if (!times.timed || !config.deskew) return se3::Vector6::Zero();
  return se3::log(motion) / (config.motion_per_second ? motion_seconds : times.seconds());
}

std::vector<Eigen::Vector3f> preprocess(const Scan& scan, const ScanTimes& times,
                                        const se3::Vector6& twist_per_second, const Config& config,
                                        const Parallel& parallel) {
  // The public program divides by the scan's duration and so loses every point of such a scan.
  const bool lost = scan.timed && !times.timed && config.deskew && !config.equal_times_are_no_times;
  if (lost) return {};
  std::vector<Eigen::Vector3f> points = deskew(scan, twist_per_second, times.reference, parallel);
  std::erase_if(points, [&](const Eigen::Vector3f& point) {
    const double range = point.cast<double>().norm();
    return !(config.min_range_m < range && range < config.max_range_m);  // NaN is dropped, too
  });
  return points;
}

}  // namespace lidarena::kiss_icp
