// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/rig.hpp"
#include "lidarena/odometry/arena_lo/config.hpp"
#include "lidarena/odometry/arena_lo/prediction.hpp"
#include "lidarena/odometry/arena_lo/registration.hpp"
#include "lidarena/odometry/odometry.hpp"

namespace lidarena::odometry::arena_lo {

/// LiDAR odometry by elastic scan-to-map registration: a scan moves in several segments of constant
/// velocity, of which the poses between them are estimated. See README.md in this folder.
class ArenaLo : public Odometry {
 public:
  ArenaLo(const Config& config, const LidarInfo& lidar, Parallel parallel);

  OdometryTraits traits() const override { return {}; }
  ScanResult register_scan(const Scan& scan) override;
  Trajectory trajectory() const override { return Trajectory(poses_, "arena_lo"); }
  std::vector<Eigen::Vector3f> map() const override;
  std::span<const Eigen::Vector3f> registered_scan() const override { return registered_scan_; }
  std::map<std::string, std::uint64_t> memory() const override;

 private:
  /// Aligns the keypoints with the map, if there is one.
  Registration align(std::span<const TimedPoint> keypoints,
                     const estimation::ScanTimes& times) const;
  ScanStatus status_of(const Registration& found, std::size_t points) const;
  /// Stores the scan's motion; inserts `frame` into the map unless the scan is `lost`.
  void advance(const estimation::ElasticMotion& motion, std::span<const TimedPoint> frame,
               const estimation::ScanTimes& times, bool lost);
  /// A scan out of time order is counted and changes nothing else.
  ScanResult refused_scan();

  Config config_;
  Pose body_from_lidar_;
  Parallel parallel_;
  map::VoxelHashMap map_;  ///< in the lidar's frame at its first pose
  MotionHistory history_;

  std::size_t scans_refused_ = 0;
  Time scan_duration_;              ///< of the last scan that had times
  std::vector<StampedPose> poses_;  ///< of the body
  std::vector<Eigen::Vector3f> registered_scan_;
};

}  // namespace lidarena::odometry::arena_lo
