// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lo/arena_lo.hpp"

#include <utility>

namespace lidarena::odometry::arena_lo {

namespace {

constexpr double kDegenerate = 0.01;  // minimum share of a direction; isotropic: 1/3

}  // namespace

ArenaLo::ArenaLo(const Config& config, const LidarInfo& lidar, Parallel parallel)
    : config_(config),
      body_from_lidar_(lidar.body_from_lidar),
      parallel_(std::move(parallel)),
      map_({config.map.voxel_size_m, config.map.max_points_per_voxel,
            config.map.min_point_spacing_m}),
      scan_duration_(from_seconds(1.0 / lidar.rate_hz)) {}

ScanResult ArenaLo::register_scan(const Scan& scan) {
  const estimation::ScanTimes times = estimation::times_of(scan, scan_duration_);
  if (!poses_.empty() && times.last <= poses_.back().stamp) return refused_scan();
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
  if (times.timed) scan_duration_ = times.last - times.first;
  poses_.push_back({times.last, body_from_lidar_ * motion.end() * body_from_lidar_.inverse()});
}

ScanResult ArenaLo::refused_scan() {
  ++scans_refused_;
  return {poses_.back(),
          ScanStatus::kTooFewPoints,
          std::nullopt,
          {.scans_refused = scans_refused_},
          {}};
}

std::vector<Eigen::Vector3f> ArenaLo::map() const {
  return transformed(body_from_lidar_, map_.points());
}

std::map<std::string, std::uint64_t> ArenaLo::memory() const {
  return {{"map", map_.memory_bytes()},
          {"scan_buffer", registered_scan_.capacity() * sizeof(Eigen::Vector3f)},
          {"backlog", 0},
          {"other", poses_.capacity() * sizeof(StampedPose)}};
}

}  // namespace lidarena::odometry::arena_lo
