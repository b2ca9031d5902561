// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/kiss_icp/kiss_icp.hpp"

#include <utility>

namespace lidarena::odometry::kiss_icp {

namespace {

// Cells around x, y, z = 0 are twice as wide: coordinates are truncated.
constexpr CellOrder kCells{map::VoxelRounding::kTruncate, 19349663U};
constexpr std::size_t kFirstScans = 3;  // are not de-skewed

/// Middle of the scan: there its pose holds, and to it its points are de-skewed.
Time middle_of(const estimation::ScanTimes& times) {
  return times.first + (times.last - times.first) / 2;
}

}  // namespace

KissIcp::KissIcp(const Config& config, const LidarInfo& lidar, Parallel parallel)
    : config_(config),
      parallel_(std::move(parallel)),
      threshold_(config),
      map_({config.voxel_size(), config.max_points_per_voxel, 0.0, kCells.rounding}),
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
  const Time instant = middle_of(times);

  const std::optional<se3::Vector6> twist = twist_of(scan, times);
  const Points points = preprocess(scan, times, twist, instant, config_, parallel_);
  const Points map_points = thin(points, kMapThinning * config_.voxel_size(), kCells);
  const Points keypoints = thin(map_points, kKeypointThinning * config_.voxel_size(), kCells);

  const double sigma = threshold_.sigma();
  const Pose guess = map_from_lidar_ * motion_;
  const Registration found =
      register_points(keypoints, map_, guess, icp_limits(sigma, sigma / 3.0, config_), parallel_);
  const ScanStatus status = status_of(found, points.size(), map_.empty());
  const Pose& pose = status == ScanStatus::kDiverged ? guess : found.map_from_lidar;
  threshold_.observe(guess, pose);

  advance(pose, map_points, times);
  append_transformed(path_.body_from_lidar() * pose, points, registered_scan_);
  return {.estimate = path_.poses().back(),
          .status = status,
          .counters = {.points = points.size()},
          .motion = twist ? motion_within(times, *twist, pose, instant, path_)
                          : std::vector<StampedPose>{},
          .details = {{"keypoints", keypoints.size()},
                      {"matches", found.matches},
                      {"iterations", found.iterations},
                      {"map_points", map_.size()},
                      {"threshold_m", sigma}}};
}

std::optional<se3::Vector6> KissIcp::twist_of(const Scan& scan,
                                              const estimation::ScanTimes& times) const {
  if (!config_.deskew || !scan.timed || path_.poses().size() < kFirstScans) return std::nullopt;
  return twist_within(times, motion_);
}

void KissIcp::advance(const Pose& pose, const Points& map_points,
                      const estimation::ScanTimes& times) {
  map_.insert(transformed(pose, map_points));
  map_.remove_far(pose.translation().cast<float>(), config_.max_range_m);
  motion_ = map_from_lidar_.inverse() * pose;
  map_from_lidar_ = pose;
  path_.add(pose, middle_of(times), times);
}

}  // namespace lidarena::odometry::kiss_icp
