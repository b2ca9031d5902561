// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lo/slices.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "lidarena/map/local_planes.hpp"
#include "lidarena/map/voxel_filter.hpp"

namespace lidarena::odometry::arena_lo {
namespace {

constexpr double kMaxSlices = 200.0;  // of a scan; bounds the time of one with a wrong stamp

}  // namespace

std::vector<Slice> slices_of(const Scan& scan, const estimation::ScanTimes& times, double longest,
                             const Config& config) {
  const double duration = times.timed ? times.seconds() : 0.0;
  const double count = std::clamp(std::ceil(duration / longest), 1.0, kMaxSlices);
  const double length = duration / count;
  std::vector<Slice> slices(static_cast<std::size_t>(count));
  const auto begin = static_cast<double>((times.first - scan.stamp).count());
  const auto middle_of = [&](std::size_t i) { return (static_cast<double>(i) + 0.5) * length; };
  for (std::size_t i = 0; i < slices.size(); ++i) {
    slices[i].middle = times.timed ? times.first + from_seconds(middle_of(i)) : times.last;
    slices[i].points.reserve(scan.points.size() / slices.size() + 1);
  }
  const double squared_min = config.min_range_m * config.min_range_m;
  const double squared_max = config.max_range_m * config.max_range_m;
  const double per_second = times.timed ? 1.0 / length : 0.0;
  for (const Point& point : scan.points) {
    const double squared_range = point.position.cast<double>().squaredNorm();
    if (!(squared_min <= squared_range && squared_range < squared_max)) continue;  // also NaN
    const double seconds = times.timed ? 1e-9 * (point.dt_ns - begin) : 0.0;
    const auto i = std::min(static_cast<std::size_t>(seconds * per_second), slices.size() - 1);
    const double since = times.timed ? seconds - middle_of(i) : 0.0;
    slices[i].points.push_back({point.position, static_cast<float>(since)});
  }
  return slices;
}

std::size_t count_points(const std::vector<Slice>& slices) {
  std::size_t count = 0;
  for (const Slice& slice : slices) count += slice.points.size();
  return count;
}

std::vector<Eigen::Vector3f> placed(const Slice& slice, const estimation::MotionState& motion,
                                    const Pose& to, const Parallel& parallel) {
  constexpr std::size_t kGrain = 4096;
  std::vector<Eigen::Vector3f> positions(slice.points.size());
  const std::size_t blocks = (positions.size() + kGrain - 1) / kGrain;
  parallel.for_each(blocks, 1, [&](std::size_t block) {
    float known = std::numeric_limits<float>::quiet_NaN();  // points often share their instant
    Eigen::Isometry3f pose = Eigen::Isometry3f::Identity();
    const std::size_t end = std::min(positions.size(), (block + 1) * kGrain);
    for (std::size_t i = block * kGrain; i < end; ++i) {
      const Slice::Point& point = slice.points[i];
      if (point.seconds != known) pose = (to * motion.pose_after(point.seconds)).cast<float>();
      known = point.seconds;
      positions[i] = pose * point.position;
    }
  });
  return positions;
}

std::vector<Eigen::Vector3f> averages(const Slice& slice, const estimation::MotionState& motion,
                                      int most, const Config& config, const Parallel& parallel) {
  const auto points = placed(slice, motion, motion.pose.inverse(), parallel);
  return map::evenly(map::voxel_means(points, config.scan_voxel_size_m, map::GridAxes::kRotated),
                     most);
}

}  // namespace lidarena::odometry::arena_lo
