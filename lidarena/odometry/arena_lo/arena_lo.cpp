// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lo/arena_lo.hpp"

#include <utility>

namespace lidarena::odometry::arena_lo {

namespace {

constexpr double kDegenerate = 0.01;  // minimum share of a direction; isotropic: 1/3

}  // namespace

ArenaLo::ArenaLo(const Config& config, const LidarInfo& lidar, Parallel parallel)
    : VoxelMapOdometry("arena_lo", lidar,
                       {config.map.voxel_size_m, config.map.max_points_per_voxel,
                        config.map.min_point_spacing_m},
                       std::move(parallel)),
      config_(config) {}

ScanResult ArenaLo::register_scan(const Scan& scan) {
  const estimation::ScanTimes times = times_of(scan);
  if (is_out_of_order(times.last)) {
    ++scans_refused_;
    return unchanged(ScanStatus::kTooFewPoints, {.scans_refused = scans_refused_});
  }
  const bool rigid = !times.timed || map_.empty();
  const SamplingConfig& sampling = config_.sampling;
  const auto points =
      estimation::timed_points(scan, times, rigid, {sampling.min_range_m, sampling.max_range_m});
  const auto frame = thin(points, sampling.scan_voxel_size_m);
  const auto keypoints = sample_keypoints(frame, sampling);

  const Registration found = align(keypoints, times);
  const ScanStatus status = status_of(found, points.size());
  const bool lost = status == ScanStatus::kTooFewPoints;
  advance(found.motion, frame, times, lost);

  const auto body_motion = estimation::moved(body_from_lidar_, found.motion);
  registered_scan_ = estimation::placed(body_motion, points, parallel_);
  return {poses_.back(),
          status,
          std::nullopt,
          {.points = points.size(),
           .keypoints = keypoints.size(),
           .matches = found.matches,
           .iterations = found.iterations,
           .map_points = map_.size(),
           .scans_refused = scans_refused_,
           .inserted = !lost},
          rigid ? std::vector<StampedPose>{}
                : estimation::body_poses(found.motion, times, body_from_lidar_)};
}

Registration ArenaLo::align(std::span<const TimedPoint> keypoints,
                            const estimation::ScanTimes& times) const {
  const Expectation expected = history_.expect(times, config_.registration.segments, config_.prior);
  if (map_.empty()) return {expected.guess};
  return register_keypoints(keypoints, map_, expected, config_.registration, parallel_);
}

ScanStatus ArenaLo::status_of(const Registration& found, std::size_t points) const {
  if (points == 0) return ScanStatus::kTooFewPoints;
  if (map_.empty()) return ScanStatus::kInitializing;
  if (found.failed) return ScanStatus::kTooFewPoints;
  return found.observability < kDegenerate ? ScanStatus::kDegenerate : ScanStatus::kTracked;
}

void ArenaLo::advance(const estimation::ElasticMotion& motion, std::span<const TimedPoint> frame,
                      const estimation::ScanTimes& times, bool lost) {
  if (!lost) map_.insert(estimation::placed(motion, frame, parallel_));
  map_.remove_far(motion.end().translation().cast<float>(), config_.map.radius_m);
  if (lost) {
    history_.add_lost(motion, times);
  } else {
    history_.add(motion, times);
  }
  store(motion.end(), times.last, times);
}

}  // namespace lidarena::odometry::arena_lo
