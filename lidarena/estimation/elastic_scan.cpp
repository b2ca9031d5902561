// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/elastic_scan.hpp"

#include <cstdint>

namespace lidarena::estimation {

std::vector<TimedPoint> timed_points(const Scan& scan, const ScanTimes& times, bool rigid,
                                     const RangeGate& gate) {
  const auto begin = static_cast<double>((times.first - scan.stamp).count());
  const auto length = static_cast<double>((times.last - times.first).count());
  const double per_ns = rigid ? 0.0 : 1.0 / length;
  const double squared_min = gate.min_m * gate.min_m;
  const double squared_max = gate.max_m * gate.max_m;
  std::vector<TimedPoint> points;
  points.reserve(scan.points.size());
  for (const Point& point : scan.points) {
    const double squared_range = point.position.cast<double>().squaredNorm();
    if (!(squared_min <= squared_range && squared_range < squared_max)) continue;  // also drops NaN
    const double alpha = rigid ? 1.0 : (point.dt_ns - begin) * per_ns;
    points.push_back({point.position, static_cast<float>(alpha)});
  }
  return points;
}

std::vector<Eigen::Vector3f> placed(const ElasticMotion& motion, std::span<const TimedPoint> points,
                                    const Parallel& parallel) {
  const ElasticTrack track(motion);
  std::vector<Eigen::Vector3f> positions(points.size());
  parallel.for_each(points.size(), kPointGrain, [&](std::size_t i) {
    const Eigen::Vector3d point = points[i].position.cast<double>();
    positions[i] = track.place(point, points[i].alpha).cast<float>();
  });
  return positions;
}

ElasticMotion constant_twist_motion(const StampedPose& known, const se3::Vector6& twist,
                                    const ScanTimes& times, int segments) {
  ElasticMotion motion;
  for (int i = 0; i <= segments; ++i) {
    const Time instant = times.first + (times.last - times.first) * i / segments;
    motion.knots.push_back(known.world_from_body *
                           se3::exp(twist * to_seconds(instant - known.stamp)));
  }
  return motion;
}

ElasticMotion moved(const Pose& by, ElasticMotion motion) {
  for (Pose& knot : motion.knots) knot = by * knot;
  return motion;
}

std::vector<StampedPose> body_poses(const ElasticMotion& motion, const ScanTimes& times,
                                    const Pose& body_from_lidar) {
  std::vector<StampedPose> poses;
  const auto segments = static_cast<std::int64_t>(motion.segments());
  for (std::int64_t i = 0; i <= segments; ++i) {
    const Time instant = times.first + (times.last - times.first) * i / segments;
    const Pose& knot = motion.knots[static_cast<std::size_t>(i)];
    poses.push_back({instant, body_from_lidar * knot * body_from_lidar.inverse()});
  }
  return poses;
}

}  // namespace lidarena::estimation
