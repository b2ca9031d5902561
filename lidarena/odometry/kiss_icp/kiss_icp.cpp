// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/kiss_icp/kiss_icp.hpp"

#include <cmath>

#include "lidarena/map/voxel_filter.hpp"

namespace lidarena::kiss_icp {

namespace {

constexpr double kMapThinning = 0.5;       // of the voxel size: points that go into the map
constexpr double kKeypointThinning = 1.5;  // of the voxel size: points that are registered
constexpr int kMotionSteps = 4;            // poses within a scan handed out, besides the first

VoxelHashMap::Options map_options(const Config& config) {
  const double spacing = config.voxel_size() / std::sqrt(config.max_points_per_voxel);
  return {config.voxel_size(), config.max_points_per_voxel, config.min_spacing ? spacing : 0.0};
}

std::vector<Eigen::Vector3f> transformed(const Pose& pose,
                                         std::span<const Eigen::Vector3f> points) {
  std::vector<Eigen::Vector3f> moved;
  moved.reserve(points.size());
  for (const Eigen::Vector3f& point : points)
    moved.push_back((pose * point.cast<double>()).cast<float>());
  return moved;
}

}  // namespace

KissIcp::KissIcp(const Config& config, const LidarInfo& lidar, Parallel parallel)
    : config_(config),
      body_from_lidar_(lidar.body_from_lidar),
      parallel_(std::move(parallel)),
      map_(map_options(config)),
      threshold_(config),
      motion_seconds_(1.0 / lidar.rate_hz),
      scan_duration_(from_seconds(1.0 / lidar.rate_hz)) {}

ScanResult KissIcp::register_scan(const Scan& scan) {
  const ScanTimes times = times_of(scan, scan_duration_, config_.pose_instant);
  const se3::Vector6 twist = twist_within(times, motion_, motion_seconds_, config_);
  const auto points = preprocess(scan, times, twist, config_, parallel_);

  const auto map_points = thin(points, kMapThinning * config_.voxel_size());
  const auto keypoints = thin(map_points, kKeypointThinning * config_.voxel_size());

  const double sigma = threshold_.sigma();
  const Pose guess = map_from_lidar_ * predicted_motion(times);
  const Registration found = register_points(keypoints, map_, guess, sigma, config_, parallel_);
  const Pose& pose = found.map_from_lidar;
  threshold_.observe(guess, pose);

  const ScanStatus status = status_of(found, points.size());
  map_.insert(transformed(pose, map_points));
  map_.remove_far(pose.translation().cast<float>(), config_.max_range_m);

  advance(pose, times, status);
  registered_scan_ = transformed(body_from_lidar_ * pose, points);
  return {poses_.back(),
          status,
          std::nullopt,
          {{"points", points.size()},
           {"keypoints", keypoints.size()},
           {"matches", found.matches},
           {"iterations", found.iterations},
           {"sigma_m", sigma},
           {"map_points", map_.size()}},
          motion_within(times, twist)};
}

Pose KissIcp::predicted_motion(const ScanTimes& times) const {
  if (!config_.motion_per_second || poses_.empty()) return motion_;
  const double seconds = to_seconds(times.reference - instant());
  return se3::exp(se3::log(motion_) * (seconds / motion_seconds_));
}

ScanStatus KissIcp::status_of(const Registration& registration, std::size_t points) const {
  if (!registration.map_from_lidar.matrix().allFinite()) return ScanStatus::kDiverged;
  if (points == 0) return ScanStatus::kTooFewPoints;
  if (map_.empty()) return ScanStatus::kInitializing;
  return registration.matches == 0 ? ScanStatus::kTooFewPoints : ScanStatus::kTracked;
}

void KissIcp::advance(const Pose& pose, const ScanTimes& times, ScanStatus status) {
  motion_ = map_from_lidar_.inverse() * pose;
  if (!poses_.empty()) motion_seconds_ = to_seconds(times.reference - instant());
  if (status == ScanStatus::kTooFewPoints)
    motion_ = se3::exp(config_.motion_kept_when_lost * se3::log(motion_));
  if (times.timed) scan_duration_ = times.last - times.first;
  map_from_lidar_ = pose;
  poses_.push_back({times.reference, body_pose(pose)});
}

std::vector<StampedPose> KissIcp::motion_within(const ScanTimes& times,
                                                const se3::Vector6& twist) const {
  std::vector<StampedPose> motion;
  if (twist.isZero(0.0)) return motion;
  for (int step = 0; step <= kMotionSteps; ++step) {
    const Time instant = times.first + (times.last - times.first) * step / kMotionSteps;
    const double seconds = to_seconds(instant - times.reference);
    motion.push_back({instant, body_pose(map_from_lidar_ * se3::exp(twist * seconds))});
  }
  return motion;
}

Pose KissIcp::body_pose(const Pose& map_from_lidar) const {
  return body_from_lidar_ * map_from_lidar * body_from_lidar_.inverse();
}

std::vector<Eigen::Vector3f> KissIcp::map() const {
  return transformed(body_from_lidar_, map_.points());
}

std::map<std::string, std::uint64_t> KissIcp::memory() const {
  return {{"map", map_.memory_bytes()},
          {"scan_buffer", registered_scan_.capacity() * sizeof(Eigen::Vector3f)},
          {"backlog", 0},
          {"other", poses_.capacity() * sizeof(StampedPose)}};
}

}  // namespace lidarena::kiss_icp
