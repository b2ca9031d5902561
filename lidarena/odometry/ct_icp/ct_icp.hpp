// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/map/voxel_hash_map.hpp"
#include "lidarena/odometry/ct_icp/config.hpp"
#include "lidarena/odometry/ct_icp/prediction.hpp"
#include "lidarena/odometry/ct_icp/quality.hpp"
#include "lidarena/odometry/ct_icp/registration.hpp"
#include "lidarena/odometry/ct_icp/robust.hpp"
#include "lidarena/odometry/lidar_path.hpp"
#include "lidarena/odometry/odometry.hpp"

namespace lidarena::odometry::ct_icp {

/// LiDAR odometry by elastic scan-to-map registration: a scan has a pose at its beginning and one
/// at its end, after Dellenbach, Deschaud, Jacquet, Goulette, "CT-ICP: Real-time Elastic LiDAR
/// Odometry with Loop Closure" (ICRA 2022). See README.md in this folder.
class CtIcp : public Odometry {
 public:
  CtIcp(const Config& config, const LidarInfo& lidar, Parallel parallel);

  OdometryTraits traits() const override { return {.publishes_scans = true}; }
  Trajectory trajectory() const override { return Trajectory(path_.poses(), "ct_icp"); }
  std::vector<Eigen::Vector3f> map() const override;
  std::span<const Eigen::Vector3f> registered_scan() const override { return registered_scan_; }
  MemoryUse memory() const override;

 protected:
  ScanResult track(const Scan& scan) override;

 private:
  /// The first scans use finer voxels and more iterations.
  bool starting() const { return scans_ < config_.sampling.initial_scans; }
  /// The result of a scan at which the method ends, or after it.
  ScanResult ended() const;
  /// The registration of a scan, and what it took.
  struct Attempts {
    Registration found;
    std::size_t keypoints = 0;  ///< of the last attempt
    int count = 0;
  };
  /// Aligns the scan with the map, if there is one; where the robust registration is enabled, again
  /// until an attempt is trusted or all are used.
  Attempts align(std::span<const TimedPoint> frame) const;
  /// One attempt.
  Registration align(std::span<const TimedPoint> keypoints,
                     const RegistrationConfig& settings) const;
  ScanStatus status_of(const Registration& found, std::size_t points) const;
  /// Stores the scan's motion, and inserts `frame` into the map; returns whether it did.
  bool advance(const Attempts& aligned, std::span<const TimedPoint> frame,
               const estimation::ScanTimes& times);

  Config config_;
  Parallel parallel_;
  map::VoxelHashMap map_;  ///< in the lidar's frame at its first pose
  LidarPath path_;
  std::vector<Eigen::Vector3f> registered_scan_;
  InsertionGate gate_;
  RobustRegistration robust_;
  MotionHistory history_;

  int scans_ = 0;
  bool ended_ = false;  ///< a registration has failed, where the program ends
};

}  // namespace lidarena::odometry::ct_icp
