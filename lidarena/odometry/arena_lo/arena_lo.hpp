// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/odometry/arena_lo/config.hpp"
#include "lidarena/odometry/arena_lo/prediction.hpp"
#include "lidarena/odometry/arena_lo/registration.hpp"
#include "lidarena/odometry/voxel_map_odometry.hpp"

namespace lidarena::odometry::arena_lo {

/// LiDAR odometry by elastic scan-to-map registration: a scan moves in several segments of constant
/// velocity, of which the poses between them are estimated. See README.md in this folder.
class ArenaLo : public VoxelMapOdometry {
 public:
  ArenaLo(const Config& config, const LidarInfo& lidar, Parallel parallel);

  ScanResult register_scan(const Scan& scan) override;

 private:
  /// Aligns the keypoints with the map, if there is one.
  Registration align(std::span<const TimedPoint> keypoints,
                     const estimation::ScanTimes& times) const;
  ScanStatus status_of(const Registration& found, std::size_t points) const;
  /// Stores the scan's motion; inserts `frame` into the map unless the scan is `lost`.
  void advance(const estimation::ElasticMotion& motion, std::span<const TimedPoint> frame,
               const estimation::ScanTimes& times, bool lost);

  Config config_;
  MotionHistory history_;

  std::size_t scans_refused_ = 0;  ///< out of time order
};

}  // namespace lidarena::odometry::arena_lo
