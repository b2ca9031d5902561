// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/imu_track.hpp"

#include <algorithm>

#include "lidarena/base/so3.hpp"
#include "lidarena/estimation/deskew.hpp"

namespace lidarena::estimation {
namespace {

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

ImuTrack bent_track(ImuTrack track, Time end, const Pose& world_from_imu_at_end) {
  if (track.empty() || track.front().begin >= end) return track;
  const Time begin = track.front().begin;
  const double seconds = to_seconds(end - begin);
  const Pose predicted = pose_at(track, end);
  const Eigen::Vector3d shift = world_from_imu_at_end.translation() - predicted.translation();
  const Eigen::Vector3d turn =
      so3::log(world_from_imu_at_end.linear() * predicted.linear().transpose());
  for (ImuStep& step : track) {
    const double share = to_seconds(step.begin - begin) / seconds;
    step.world_from_imu = make_pose(so3::exp(share * turn) * step.world_from_imu.linear(),
                                    step.world_from_imu.translation() + share * shift);
    step.velocity += shift / seconds;
    step.rate += step.world_from_imu.linear().transpose() * turn / seconds;
  }
  return track;
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
  parallel.for_blocks(scan.points.size(), kPointGrain, [&](std::size_t begin, std::size_t stop) {
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
