// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/voxel_map_odometry.hpp"

#include <utility>

namespace lidarena::odometry {

VoxelMapOdometry::VoxelMapOdometry(const char* name, const LidarInfo& lidar,
                                   const map::VoxelHashMap::Options& options, Parallel parallel)
    : body_from_lidar_(lidar.body_from_lidar),
      parallel_(std::move(parallel)),
      map_(options),
      name_(name),
      scan_duration_(from_seconds(1.0 / lidar.rate_hz)) {}

std::vector<Eigen::Vector3f> VoxelMapOdometry::map() const {
  return transformed(body_from_lidar_, map_.points());
}

std::map<std::string, std::uint64_t> VoxelMapOdometry::memory() const {
  return {{"map", map_.memory_bytes()},
          {"scan_buffer", registered_scan_.capacity() * sizeof(Eigen::Vector3f)},
          {"backlog", 0},
          {"other", poses_.capacity() * sizeof(StampedPose)}};
}

estimation::ScanTimes VoxelMapOdometry::times_of(const Scan& scan) const {
  return estimation::times_of(scan, scan_duration_);
}

bool VoxelMapOdometry::is_out_of_order(Time instant) const {
  return !poses_.empty() && instant <= poses_.back().stamp;
}

ScanResult VoxelMapOdometry::unchanged(ScanStatus status, const ScanCounters& counters) const {
  return {poses_.back(), status, std::nullopt, counters, {}};
}

void VoxelMapOdometry::store(const Pose& map_from_lidar, Time instant,
                             const estimation::ScanTimes& times) {
  poses_.push_back({instant, body_from_lidar_ * map_from_lidar * body_from_lidar_.inverse()});
  if (times.timed) scan_duration_ = times.last - times.first;
}

}  // namespace lidarena::odometry
