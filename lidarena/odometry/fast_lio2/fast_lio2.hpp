// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/rig.hpp"
#include "lidarena/estimation/imu_buffer.hpp"
#include "lidarena/map/kd_tree.hpp"
#include "lidarena/odometry/fast_lio2/config.hpp"
#include "lidarena/odometry/fast_lio2/local_map.hpp"
#include "lidarena/odometry/fast_lio2/preprocess.hpp"
#include "lidarena/odometry/fast_lio2/propagation.hpp"
#include "lidarena/odometry/odometry.hpp"

namespace lidarena::odometry::fast_lio2 {

/// Tightly coupled LiDAR-inertial odometry: an iterated error-state Kalman filter that registers
/// raw points with planes of the map, after Xu, Cai, He, Lin, Zhang, "FAST-LIO2: Fast Direct
/// LiDAR-Inertial Odometry" (IEEE T-RO 2022), as its program does. See README.md in this folder.
class FastLio2 : public Odometry {
 public:
  FastLio2(const Config& config, const LidarInfo& lidar, const ImuInfo& imu, Parallel parallel);

  OdometryTraits traits() const override { return {.needs_imu = true, .publishes_scans = true}; }
  void register_imu(const ImuSample& sample) override { imu_.add(sample); }
  Trajectory trajectory() const override { return Trajectory(poses_, "fast_lio2"); }
  std::vector<Eigen::Vector3f> map() const override;
  std::span<const Eigen::Vector3f> registered_scan() const override { return registered_scan_; }
  MemoryUse memory() const override;

 protected:
  ScanResult track(const Scan& scan) override;

 private:
  /// Initializes with the samples up to `end`, except those of the first scan; the estimate is then
  /// that of the last sample.
  void start(Time end);
  /// Propagates the estimate to the end of the scan.
  void predict(const ScanSpan& scan);
  /// Keeps the scan (m) as the program publishes it. The program also keeps all scans before; here
  /// the bytes of that buffer are counted, and the runner writes the scans to a file.
  void publish(std::vector<Eigen::Vector3f> in_world);
  /// The result with the current estimate, which is that at `end`.
  ScanResult finish_scan(const Scan& scan, Time end, ScanStatus status);

  Config config_;
  bool is_livox_;
  double rate_hz_;         ///< scans per second
  Pose world_from_start_;  ///< body's frame at the start, from the IMU's at the start
  Pose imu_from_body_;
  Pose imu_from_lidar_;  ///< as given
  Parallel parallel_;

  estimation::ImuBuffer imu_;
  ScanClock clock_;
  bool first_scan_ = true;
  bool started_ = false;
  double accel_scale_ = 1.0;
  std::vector<ImuSample> start_samples_;
  Time estimated_{Time::min()};  ///< instant of the estimate
  estimation::StateEstimate estimate_;
  estimation::ImuTrack track_;  ///< of the last scan
  map::KdTree map_;
  MapBox box_;
  ScanCounters counters_;  ///< of the scan at hand, as are the details
  ScanDetails details_;

  std::vector<StampedPose> poses_;
  std::vector<Eigen::Vector3f> registered_scan_;
  std::size_t archived_bytes_ = 0;  ///< that the program's buffer of all scans would hold
};

}  // namespace lidarena::odometry::fast_lio2
