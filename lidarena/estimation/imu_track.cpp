// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/imu_track.hpp"

#include <algorithm>

#include "lidarena/base/so3.hpp"
#include "lidarena/estimation/deskew.hpp"

namespace lidarena::estimation {
namespace {

constexpr std::size_t kGrain = 2048;  // points per task

Pose extrapolate(const ImuStep& step, Time t) {
  const double s = to_seconds(t - step.begin);
  return make_pose(
      step.world_from_imu.linear() * so3::exp(step.rate * s),
      step.world_from_imu.translation() + s * step.velocity + 0.5 * s * s * step.acceleration);
}

}  // namespace

Pose pose_at(const ImuTrack& track, Time t) {
  const auto after =
      std::upper_bound(track.begin(), track.end(), t,
                       [](Time instant, const ImuStep& step) { return instant < step.begin; });
  return extrapolate(after == track.begin() ? *after : *(after - 1), t);
}

std::vector<StampedPose> motion_along(const ImuTrack& track, Time begin, Time end, Time at,
                                      const Pose& world_from_imu_at, const Pose& imu_from_body) {
  std::vector<StampedPose> motion;
  if (track.empty() || begin >= end) return motion;
  const Pose world_from_track = world_from_imu_at * pose_at(track, at).inverse();
  const auto add = [&](Time t) {
    motion.push_back({t, orthonormalized(world_from_track * pose_at(track, t) * imu_from_body)});
  };
  add(begin);
  for (const ImuStep& step : track) {
    if (step.begin > begin && step.begin < end) add(step.begin);
  }
  add(end);
  return motion;
}

std::vector<Eigen::Vector3f> deskew(const Scan& scan, const ImuTrack& track,
                                    const Pose& imu_from_lidar, const Pose& world_from_imu_at_end,
                                    const Parallel& parallel) {
  if (!scan.timed || track.empty()) return positions(scan);
  const Pose end_from_world = (world_from_imu_at_end * imu_from_lidar).inverse();
  std::vector<Eigen::Vector3f> moved(scan.points.size());
  parallel.for_blocks(scan.points.size(), kGrain, [&](std::size_t begin, std::size_t stop) {
    Time known = Time::min();  // points measured at the same time share the pose
    Pose end_from_lidar = Pose::Identity();
    for (std::size_t i = begin; i < stop; ++i) {
      const Time t = time_of(scan, scan.points[i]);
      if (t != known) end_from_lidar = end_from_world * pose_at(track, t) * imu_from_lidar;
      known = t;
      moved[i] = (end_from_lidar * scan.points[i].position.cast<double>()).cast<float>();
    }
  });
  return moved;
}

}  // namespace lidarena::estimation
