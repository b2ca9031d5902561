// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/kiss_icp/kiss_icp.hpp"

#include <cmath>
#include <utility>

namespace lidarena::odometry::kiss_icp {

namespace {

constexpr int kMotionSteps = 4;  // ScanResult::motion has one pose more

map::VoxelHashMap::Options map_options(const Config& config) {
  const double spacing = config.voxel_size() / std::sqrt(config.max_points_per_voxel);
  return {config.voxel_size(), config.max_points_per_voxel, config.min_spacing ? spacing : 0.0,
          config.voxel_rounding, config.plane_thinness.value_or(0.0)};
}

double mean_range(std::span<const Eigen::Vector3f> points) {
  double sum = 0.0;
  for (const Eigen::Vector3f& point : points) sum += point.cast<double>().norm();
  return points.empty() ? 0.0 : sum / static_cast<double>(points.size());
}

/// Adds the result of the next slice to that of the scan: counters are summed, all else is taken
/// from the slice.
void append(ScanResult slice, ScanResult& scan) {
  const auto add = [](ScanCounters::Count& sum, const ScanCounters::Count& count) {
    sum = sum.value_or(0) + count.value_or(0);
  };
  add(slice.counters.points, scan.counters.points);
  add(slice.counters.keypoints, scan.counters.keypoints);
  add(slice.counters.matches, scan.counters.matches);
  add(slice.counters.iterations, scan.counters.iterations);
  // a slice starts where the previous one ended, or just after
  for (const StampedPose& pose : slice.motion) {
    if (scan.motion.empty() || pose.stamp > scan.motion.back().stamp) scan.motion.push_back(pose);
  }
  slice.motion = std::move(scan.motion);
  scan = std::move(slice);
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
  const estimation::ScanTimes times = estimation::times_of(scan, scan_duration_);
  if (times.timed) scan_duration_ = times.last - times.first;
  registered_scan_.clear();
  ScanResult result;
  const bool in_start = poses_.size() < static_cast<std::size_t>(config_.initial_scans);
  const bool whole = in_start || threshold_.sigma() <= config_.slice_above_m;
  scan_motion_share_ = in_start ? 0.0 : config_.scan_motion_share;
  for (const Scan& slice : sliced(scan, whole ? 1 : config_.slices))
    append(register_slice(slice), result);
  poses_.push_back(result.estimate);
  return result;
}

ScanResult KissIcp::register_slice(const Scan& slice) {
  const estimation::ScanTimes times = estimation::times_of(slice, scan_duration_);
  const se3::Vector6 before = twist_within(times, motion_, motion_seconds_, config_);
  const TimedPoints points = preprocess(slice, times, before, config_, parallel_);

  const double voxel = config_.voxel_size();
  const map::Thinning thinning{config_.voxel_rounding, config_.thinning_order};
  const TimedPoints map_points = thin(points, config_.map_thinning * voxel, thinning);
  const TimedPoints keypoints = thin(map_points, config_.keypoint_thinning * voxel, thinning);

  const double sigma = threshold_.sigma();
  const Pose guess = map_from_lidar_ * predicted_motion(times);
  const Registration found = registered(keypoints, previous_pose(times, before), guess);
  const Pose& pose = found.map_from_lidar;
  threshold_.observe(guess, pose, mean_range(keypoints.positions));

  const ScanStatus status = status_of(found, points.size());
  const se3::Vector6 twist =
      points.deskewed() ? before
                        : twist_towards(pose, previous_pose(times, before), scan_motion_share_);
  if (config_.redeskew_first_scan && map_.empty()) first_points_ = map_points;
  map_.insert(transformed(pose, deskewed(map_points, twist, parallel_)));
  map_.remove_far(pose.translation().cast<float>(), config_.max_range_m);

  advance(pose, times, status);
  for (const auto& p : transformed(body_from_lidar_ * pose, deskewed(points, twist, parallel_)))
    registered_scan_.push_back(p);
  return {{reference_of(times), body_pose(pose)},
          status,
          std::nullopt,
          {.points = points.size(),
           .keypoints = keypoints.size(),
           .matches = found.matches,
           .iterations = found.iterations,
           .map_points = map_.size(),
           .threshold_m = sigma},
          motion_within(times, twist)};
}

Registration KissIcp::registered(const TimedPoints& keypoints, const PreviousPose& previous_pose,
                                 const Pose& guess) {
  const double sigma = threshold_.sigma();
  const auto register_from = [&](const Pose& start) {
    return register_points(keypoints, map_, previous_pose, start, sigma, scan_motion_share_,
                           config_, parallel_);
  };
  const Registration found = register_from(guess);
  if (first_points_.size() == 0 || found.matches == 0) return found;
  const TimedPoints first = std::exchange(first_points_, {});
  if (first.deskewed()) return found;
  const se3::Vector6 twist = twist_towards(found.map_from_lidar, previous_pose, 1.0);
  map_ = map::VoxelHashMap(map_options(config_));
  map_.insert(transformed(previous_pose.map_from_lidar, deskewed(first, twist, parallel_)));
  return register_from(found.map_from_lidar);
}

PreviousPose KissIcp::previous_pose(const estimation::ScanTimes& times,
                                    const se3::Vector6& before) const {
  return {map_from_lidar_, instant_ ? to_seconds(reference_of(times) - *instant_) : 0.0, before};
}

Pose KissIcp::predicted_motion(const estimation::ScanTimes& times) const {
  if (!config_.motion_per_second || !instant_) return motion_;
  const double seconds = to_seconds(reference_of(times) - *instant_);
  return se3::exp(se3::log(motion_) * (seconds / motion_seconds_));
}

ScanStatus KissIcp::status_of(const Registration& registration, std::size_t points) const {
  if (!registration.map_from_lidar.matrix().allFinite()) return ScanStatus::kDiverged;
  if (points == 0) return ScanStatus::kTooFewPoints;
  if (map_.empty()) return ScanStatus::kInitializing;
  return registration.matches == 0 ? ScanStatus::kTooFewPoints : ScanStatus::kTracked;
}

void KissIcp::advance(const Pose& pose, const estimation::ScanTimes& times, ScanStatus status) {
  motion_ = map_from_lidar_.inverse() * pose;
  if (instant_) motion_seconds_ = to_seconds(reference_of(times) - *instant_);
  if (status == ScanStatus::kTooFewPoints)
    motion_ = se3::exp(config_.lost_motion_factor * se3::log(motion_));
  map_from_lidar_ = pose;
  instant_ = reference_of(times);
}

std::vector<StampedPose> KissIcp::motion_within(const estimation::ScanTimes& times,
                                                const se3::Vector6& twist) const {
  std::vector<StampedPose> motion;
  if (twist.isZero(0.0)) return motion;
  for (int step = 0; step <= kMotionSteps; ++step) {
    const Time instant = times.first + (times.last - times.first) * step / kMotionSteps;
    const double seconds = to_seconds(instant - reference_of(times));
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

}  // namespace lidarena::odometry::kiss_icp
