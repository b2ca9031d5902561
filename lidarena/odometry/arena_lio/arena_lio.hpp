// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/rig.hpp"
#include "lidarena/estimation/gyro_calibration.hpp"
#include "lidarena/estimation/imu_buffer.hpp"
#include "lidarena/estimation/imu_track.hpp"
#include "lidarena/estimation/iterated_update.hpp"
#include "lidarena/map/local_planes.hpp"
#include "lidarena/odometry/arena_lio/config.hpp"
#include "lidarena/odometry/arena_lio/initialization.hpp"
#include "lidarena/odometry/arena_lio/plane_residuals.hpp"
#include "lidarena/odometry/arena_lio/tracking.hpp"
#include "lidarena/odometry/odometry.hpp"

namespace lidarena::odometry::arena_lio {

/// Tightly coupled LiDAR-inertial odometry: FAST-LIO2's iterated Kalman filter against a map of
/// planes, with a robust kernel, a calibration of the gyro while it flies, scans that are de-skewed
/// by the estimate before they enter the map, and tests for standstill, saturation and lost
/// tracking. See README.md in this folder.
class ArenaLio : public Odometry {
 public:
  ArenaLio(const Config& config, const LidarInfo& lidar, const ImuInfo& imu, Parallel parallel);

  OdometryTraits traits() const override {
    return {
        .needs_imu = true, .revises_past = true, .gravity_aligned = true, .publishes_scans = true};
  }
  void register_imu(const ImuSample& sample) override {
    imu_.add(sample);
    measured_noise_.add(sample);
  }
  Trajectory trajectory() const override { return Trajectory(poses_, "arena_lio"); }
  std::vector<Eigen::Vector3f> map() const override;
  std::span<const Eigen::Vector3f> registered_scan() const override { return registered_scan_; }
  Pose leveled_from_world() const override;
  MemoryUse memory() const override;

 protected:
  ScanResult track(const Scan& scan) override;

 private:
  using State = estimation::InertialState;

  /// Instant of the scan's last firing; for a scan without points, its expected instant.
  Time scan_end(const Scan& scan);
  /// The samples since the end of the last scan.
  std::vector<ImuSample> new_samples(Time end) const;
  /// IMU intervals since the end of the last scan, or since the first sample.
  std::vector<estimation::ImuInterval> intervals_until(Time end);
  /// How a scan fits the map.
  struct Match {
    estimation::IteratedUpdate update;
    Agreement agreement;
    std::size_t keypoints = 0;
  };

  struct OpeningScan {
    Scan usable;
    Time end{0};
    std::vector<estimation::ImuInterval> intervals;  ///< of the IMU, up to its end
  };
  /// Of a start in motion: the first scans, and the estimate at the end of the very first.
  struct Opening {
    std::vector<OpeningScan> scans;
    estimation::StateEstimate estimate;
  };

  /// Collects samples and initializes once there are enough; returns whether it has.
  bool start(const std::vector<ImuSample>& samples);
  /// Of a start in motion: registers the opening again, from the velocity, gravity and biases at
  /// the first scan's end that follow from the latest scan, which then belongs to it. Leaves the
  /// estimate and the map of all scans but the latest.
  void begin_again(OpeningScan latest);
  /// Estimate, map and poses by the scans of the opening.
  void replay_opening();
  /// The iterated update of the estimate with averages of the scan's points.
  Match match(const Scan& usable) const;
  /// Whether the sensor stands still; if so, updates the filter with this knowledge.
  bool stands(const std::vector<ImuSample>& samples, const State& predicted);
  /// Propagates state and covariance over the intervals and stores the track for de-skewing.
  void predict(const std::vector<estimation::ImuInterval>& intervals);
  /// Learns the gyro's calibration and the delay of its clock from what the update has changed in
  /// the rotation of a scan.
  void calibrate(const State& predicted);
  /// Positions of the scan's points in the LiDAR's frame at the scan's end, by the current track.
  std::vector<Eigen::Vector3f> deskewed(const Scan& usable) const;
  /// Adds a scan (m, LiDAR frame at its end) to the map.
  void insert(const std::vector<Eigen::Vector3f>& points);
  /// The same, unless the sensor has long stood still; what is far is removed.
  void grow_map(const std::vector<Eigen::Vector3f>& points);
  Pose world_from_body() const;
  /// By the gravity that the filter estimates.
  UpDirection up() const;
  /// The result with the current estimate, which is that at `end`.
  ScanResult finish_scan(Time begin, Time end, ScanStatus status, std::size_t points,
                         ScanDetails details);

  Config config_;
  Pose lidar_from_body_;            ///< as told: the body stays where the LiDAR is told to be on it
  Eigen::Matrix3d map_from_start_;  ///< rotation from the IMU's frame at the start to the map's
  Pose world_from_map_;
  Pose imu_from_lidar_;
  estimation::ImuNoise noise_;  ///< as told, with its factors
  estimation::MeasuredNoise measured_noise_;
  Parallel parallel_;

  estimation::ImuBuffer imu_;
  std::optional<Time> integrated_until_;  ///< by the LiDAR's clock; none until there are samples
  double longest_gap_s_ = 0.0;            ///< of the IMU, in the last scan
  std::size_t saturated_ = 0;             ///< intervals of the IMU, in the last scan
  std::vector<ImuSample> start_samples_;
  bool started_ = false;
  std::optional<Opening> opening_;  ///< none once it is complete, or after a start at rest
  double accel_scale_ = 1.0;

  estimation::StateEstimate
      estimate_;  ///< state and covariance at the end of the last scan, in the map's frame
  estimation::ImuTrack track_;
  estimation::GyroCalibration gyro_;
  Eigen::Vector3d turned_ = Eigen::Vector3d::Zero();  ///< rad, over the last scan, in its end's
  Eigen::Vector3d rate_change_ = Eigen::Vector3d::Zero();  ///< rad/s, from scan to scan, likewise
  std::optional<Eigen::Vector3d> mean_rate_;               ///< rad/s, of the last scan, map's axes
  Tracking tracking_;
  StillDetector still_;
  Pose first_pose_ = Pose::Identity();  ///< of the IMU
  bool has_moved_ = false;
  map::LocalPlanes map_;

  Time scan_duration_;              ///< duration of the last scan that had points
  std::vector<StampedPose> poses_;  ///< of the body, in the world
  std::vector<Eigen::Vector3f> registered_scan_;
};

}  // namespace lidarena::odometry::arena_lio
