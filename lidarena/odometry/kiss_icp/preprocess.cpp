// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/kiss_icp/preprocess.hpp"

#include <algorithm>

#include "lidarena/estimation/deskew.hpp"

namespace lidarena::odometry::kiss_icp {

Time pose_time(const estimation::ScanTimes& times, PoseInstant instant) {
  return instant == PoseInstant::kScanEnd ? times.last
                                          : times.first + (times.last - times.first) / 2;
}

std::vector<Scan> sliced(const Scan& scan, int count) {
  const estimation::ScanTimes times = estimation::times_of(scan, Time{0});
  const std::int64_t duration = (times.last - times.first).count();
  if (count == 1 || !times.timed || duration < count) return {scan};
  std::vector<Scan> slices(static_cast<std::size_t>(count), Scan{scan.stamp, {}, true});
  for (Scan& slice : slices) slice.points.reserve(scan.points.size() / slices.size() + 1);
  const Time width{duration / count + 1};
  for (const Point& point : scan.points) {
    const auto slice = static_cast<std::size_t>((time_of(scan, point) - times.first) / width);
    slices[slice].points.push_back(point);
  }
  std::erase_if(slices, [](const Scan& slice) { return slice.points.empty(); });
  return slices;
}

se3::Vector6 twist_within(const estimation::ScanTimes& times, const Pose& motion,
                          double motion_seconds, const Config& config) {
  if (!times.timed || !config.deskew) return se3::Vector6::Zero();
  return se3::log(motion) / (config.motion_per_second ? motion_seconds : times.seconds());
}

TimedPoints preprocess(const Scan& scan, const estimation::ScanTimes& times,
                       const se3::Vector6& twist_per_second, const Config& config,
                       const Parallel& parallel) {
  // The published program divides by the scan's duration and so loses all points of such a scan.
  const bool lost = scan.timed && !times.timed && config.deskew && !config.ignore_equal_times;
  if (lost) return {};
  const bool estimated = times.timed && config.deskew && config.scan_motion_share > 0.0;
  const Time reference = pose_time(times, config.pose_instant);
  const std::vector<Eigen::Vector3f> positions =
      estimated ? lidarena::estimation::positions(scan)
                : estimation::deskew(scan, twist_per_second, reference, parallel);
  TimedPoints kept;
  kept.positions.reserve(positions.size());
  if (estimated) kept.seconds.reserve(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const double range = positions[i].cast<double>().norm();
    if (!(config.min_range_m < range && range < config.max_range_m)) continue;  // also drops NaN
    kept.positions.push_back(positions[i]);
    if (!estimated) continue;
    kept.seconds.push_back(
        static_cast<float>(to_seconds(time_of(scan, scan.points[i]) - reference)));
  }
  return kept;
}

TimedPoints thin(const TimedPoints& points, double voxel_size, const map::Thinning& thinning) {
  const auto indices = map::downsampled_indices(points.positions, voxel_size, thinning);
  TimedPoints thinned;
  thinned.positions.reserve(indices.size());
  for (const std::uint32_t i : indices) thinned.positions.push_back(points.positions[i]);
  if (points.deskewed()) return thinned;
  thinned.seconds.reserve(indices.size());
  for (const std::uint32_t i : indices) thinned.seconds.push_back(points.seconds[i]);
  return thinned;
}

std::vector<Eigen::Vector3f> deskewed(const TimedPoints& points,
                                      const se3::Vector6& twist_per_second,
                                      const Parallel& parallel) {
  if (points.deskewed()) return points.positions;
  constexpr std::size_t kGrain = 2048;  // points per task: about 0.1 ms of work
  const estimation::ConstantTwist reference_from_instant(twist_per_second);
  std::vector<Eigen::Vector3f> moved(points.size());
  parallel.for_each(points.size(), kGrain, [&](std::size_t i) {
    const Pose pose = reference_from_instant.at(double{points.seconds[i]});
    moved[i] = (pose * points.positions[i].cast<double>()).cast<float>();
  });
  return moved;
}

}  // namespace lidarena::odometry::kiss_icp
