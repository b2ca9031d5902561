// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/kiss_icp/kiss_icp.hpp"

#include <utility>

#include "lidarena/base/se3.hpp"
#include "lidarena/estimation/deskew.hpp"

namespace lidarena::odometry::kiss_icp {

namespace {

constexpr int kMotionSteps = 4;  // ScanResult::motion has one pose more

map::VoxelHashMap::Options map_options(const Config& config) {
  return {config.voxel_size(), config.max_points_per_voxel,
          point_spacing(config.release, config.voxel_size(), config.max_points_per_voxel),
          cell_rounding(config.release)};
}

}  // namespace

KissIcp::KissIcp(const Config& config, const LidarInfo& lidar, Parallel parallel)
    : config_(config),
      parallel_(std::move(parallel)),
      threshold_(config),
      map_(map_options(config)),
      path_(lidar) {}

std::vector<Eigen::Vector3f> KissIcp::map() const {
  return transformed(path_.body_from_lidar(), map_.points());
}

MemoryUse KissIcp::memory() const {
  return {.map = map_.memory_bytes(),
          .scan_buffer = registered_scan_.capacity() * sizeof(Eigen::Vector3f),
          .other = path_.memory_bytes()};
}

ScanResult KissIcp::track(const Scan& scan) {
  registered_scan_.clear();
  const estimation::ScanTimes times = path_.times_of(scan);
  const Time instant = pose_instant(config_.release, times);

  const se3::Vector6 twist = deskews(scan) ? twist_within(times, motion_) : se3::Vector6::Zero();
  const Points points = preprocess(scan, times, twist, instant);
  const Points map_points = thin(points, kMapThinning * config_.voxel_size(), config_.release);
  const Points keypoints =
      thin(map_points, kKeypointThinning * config_.voxel_size(), config_.release);

  const double sigma = threshold_.sigma();
  const Pose guess = map_from_lidar_ * motion_;
  const Registration found =
      register_points(keypoints, map_, guess, icp_limits(sigma, config_), parallel_);
  const ScanStatus status = status_of(found, points.size());
  const Pose& pose = status == ScanStatus::kDiverged ? guess : found.map_from_lidar;
  threshold_.observe(guess, pose);

  advance(pose, map_points, times);
  append_transformed(path_.body_from_lidar() * pose, points, registered_scan_);
  return {.estimate = path_.poses().back(),
          .status = status,
          .counters = {.points = points.size()},
          .motion = motion_within(times, twist),
          .details = {{"keypoints", keypoints.size()},
                      {"matches", found.matches},
                      {"iterations", found.iterations},
                      {"map_points", map_.size()},
                      {"threshold_m", sigma}}};
}

bool KissIcp::deskews(const Scan& scan) const {
  return config_.deskew && scan.timed &&
         path_.poses().size() >= scans_before_deskewing(config_.release);
}

Points KissIcp::preprocess(const Scan& scan, const estimation::ScanTimes& times,
                           const se3::Vector6& twist, Time instant) const {
  if (!deskews(scan)) return in_range(estimation::positions(scan), config_);
  // The published program divides by the scan's duration and so loses all points of such a scan.
  if (!times.timed) return {};
  return in_range(estimation::deskew(scan, twist, instant, parallel_), config_);
}

ScanStatus KissIcp::status_of(const Registration& registration, std::size_t points) const {
  if (!registration.map_from_lidar.matrix().allFinite()) return ScanStatus::kDiverged;
  if (points == 0) return ScanStatus::kTooFewPoints;
  if (map_.empty()) return ScanStatus::kInitializing;
  return registration.matches == 0 ? ScanStatus::kTooFewPoints : ScanStatus::kTracked;
}

void KissIcp::advance(const Pose& pose, const Points& map_points,
                      const estimation::ScanTimes& times) {
  map_.insert(transformed(pose, map_points));
  map_.remove_far(pose.translation().cast<float>(), config_.max_range_m);
  motion_ = map_from_lidar_.inverse() * pose;
  map_from_lidar_ = pose;
  path_.add(pose, pose_instant(config_.release, times), times);
}

std::vector<StampedPose> KissIcp::motion_within(const estimation::ScanTimes& times,
                                                const se3::Vector6& twist) const {
  if (twist.isZero(0.0)) return {};
  const Time known = pose_instant(config_.release, times);
  std::vector<StampedPose> poses;
  for (int i = 0; i <= kMotionSteps; ++i) {
    const Time instant = times.first + (times.last - times.first) * i / kMotionSteps;
    const Pose map_from_lidar = map_from_lidar_ * se3::exp(twist * to_seconds(instant - known));
    poses.push_back({instant, path_.body_pose(map_from_lidar)});
  }
  return poses;
}

}  // namespace lidarena::odometry::kiss_icp
