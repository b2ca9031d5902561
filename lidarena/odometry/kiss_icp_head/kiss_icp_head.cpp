// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/kiss_icp_head/kiss_icp_head.hpp"

#include <cmath>
#include <utility>

namespace lidarena::odometry::kiss_icp_head {

namespace {

using kiss_icp::CellOrder;
using kiss_icp::kKeypointThinning;
using kiss_icp::kMapThinning;
using kiss_icp::motion_within;
using kiss_icp::Registration;
using kiss_icp::twist_within;

constexpr CellOrder kCells{map::VoxelRounding::kFloor, 19349669U};

/// Points of a cell are at least voxel / sqrt(maximum count) apart.
map::VoxelHashMap::Options map_options(const Config& config) {
  return {config.voxel_size(), config.max_points_per_voxel,
          config.voxel_size() / std::sqrt(config.max_points_per_voxel), kCells.rounding};
}

}  // namespace

KissIcpHead::KissIcpHead(const Config& config, const LidarInfo& lidar, Parallel parallel)
    : config_(config),
      parallel_(std::move(parallel)),
      threshold_(config),
      map_(map_options(config)),
      path_(lidar) {}

std::vector<Eigen::Vector3f> KissIcpHead::map() const {
  return transformed(path_.body_from_lidar(), map_.points());
}

MemoryUse KissIcpHead::memory() const {
  return {.map = map_.memory_bytes(),
          .scan_buffer = registered_scan_.capacity() * sizeof(Eigen::Vector3f),
          .other = path_.memory_bytes()};
}

ScanResult KissIcpHead::track(const Scan& scan) {
  registered_scan_.clear();
  const estimation::ScanTimes times = path_.times_of(scan);
  const Time instant = times.last;

  const std::optional<se3::Vector6> twist = twist_of(scan, times);
  const Points points = preprocess(scan, times, twist, instant, config_, parallel_);
  const Points map_points = thin(points, kMapThinning * config_.voxel_size(), kCells);
  const Points keypoints = thin(map_points, kKeypointThinning * config_.voxel_size(), kCells);

  const double sigma = threshold_.sigma();
  const Pose guess = map_from_lidar_ * motion_;
  const Registration found =
      register_points(keypoints, map_, guess, icp_limits(sigma, sigma, config_), parallel_);
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

std::optional<se3::Vector6> KissIcpHead::twist_of(const Scan& scan,
                                                  const estimation::ScanTimes& times) const {
  if (!config_.deskew || !scan.timed) return std::nullopt;
  return twist_within(times, motion_);
}

void KissIcpHead::advance(const Pose& pose, const Points& map_points,
                          const estimation::ScanTimes& times) {
  map_.insert(transformed(pose, map_points));
  map_.remove_far(pose.translation().cast<float>(), config_.max_range_m);
  motion_ = map_from_lidar_.inverse() * pose;
  map_from_lidar_ = pose;
  path_.add(pose, times.last, times);
}

}  // namespace lidarena::odometry::kiss_icp_head
