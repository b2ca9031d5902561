// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/rig.hpp"
#include "lidarena/estimation/imu_buffer.hpp"
#include "lidarena/estimation/iterated_update.hpp"
#include "lidarena/map/local_planes.hpp"
#include "lidarena/odometry/arena_lio/config.hpp"
#include "lidarena/odometry/arena_lio/filter.hpp"
#include "lidarena/odometry/arena_lio/plane_residuals.hpp"
#include "lidarena/odometry/arena_lio/slices.hpp"
#include "lidarena/odometry/odometry.hpp"
#include "lidarena/odometry/tracking.hpp"

namespace lidarena::odometry::arena_lio {

/// Tightly coupled LiDAR-inertial odometry: FAST-LIO2's iterated Kalman filter against a map of
/// planes, with a robust kernel, a calibration of the gyro while it flies, scans that are
/// registered in slices where the IMU is noisy and de-skewed by the smoothed motion before they
/// enter the map, and tests for standstill, saturation and lost tracking. See README.md in this
/// folder.
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
  using Intervals = std::vector<estimation::ImuInterval>;

  /// The IMU's data since the end of the last scan.
  struct ScanImu {
    std::vector<ImuSample> samples;
    std::vector<estimation::ImuInterval> intervals;
    double longest_gap_s = 0.0;
    std::size_t saturated = 0;  ///< intervals
  };

  /// A scan with which a start in motion is registered again.
  struct OpeningScan {
    Scan usable;
    Time end{0};
    std::vector<estimation::ImuInterval> intervals;  ///< up to its end
  };
  /// Of a start in motion: the first scans, and the estimate at the end of the very first.
  struct Opening {
    std::vector<OpeningScan> scans;
    estimation::StateEstimate estimate;
  };
  /// How far the start is.
  struct Start {
    std::vector<ImuSample> samples;  ///< until the initialization
    bool initialized = false;
    std::optional<Opening> opening;  ///< none once it is complete, or after a start at rest
  };

  /// What the scans have shown of the surroundings.
  struct World {
    Pose world_from_map;
    map::LocalPlanes map;
  };

  /// How points fit the map.
  struct Match {
    estimation::IteratedUpdate update;
    Agreement agreement;
    std::size_t keypoints = 0;  ///< averages
    std::size_t returns = 0;

    double returns_per_keypoint() const {
      return static_cast<double>(returns) / static_cast<double>(keypoints);
    }
  };
  /// A scan's slices, registered one after the other.
  struct Registration {
    Filter predicted;  ///< before the update by the last slice
    Match match;       ///< the last update, and the sums over all slices
    std::vector<Correction> corrections;
  };
  /// A scan that the next one revises.
  struct LastScan {
    Time begin{0}, end{0};
    estimation::ImuTrack track;
  };
  /// Filter and world after scans that were registered again, and the body's poses.
  struct Replay {
    Filter filter;
    World world;
    std::vector<StampedPose> poses;
  };

  /// Instant of the scan's last firing; for a scan without points, its expected instant.
  Time scan_end(const Scan& scan);
  /// Takes the IMU's data up to `end` from the buffer.
  ScanImu imu_until(Time end);
  /// Collects samples and, once there are enough, initializes start, filter and world.
  void initialize(const std::vector<ImuSample>& samples);
  /// Of a start in motion: registers the opening again, from the velocity, gravity and biases at
  /// the first scan's end that follow from the latest scan, which then belongs to it. Leaves filter
  /// and world after all scans but the latest, and revises the poses.
  void begin_again(OpeningScan latest);

  // The steps: each returns what it changes.

  /// The noise of the IMU as it is stated, or as samples and corrections show where that is more.
  estimation::ImuNoise noise_by(const Filter& filter) const;
  /// The state at the end of the intervals.
  Filter predict(Filter filter, const std::vector<estimation::ImuInterval>& intervals) const;
  /// The iterated update of the filter's prediction with averages of the scan's points.
  Match match(const Scan& usable, const Filter& predicted, const map::LocalPlanes& map) const;
  /// How many slices of the scan the noise of the IMU asks for.
  int slices_of(const Scan& usable, const ScanImu& imu, Time end) const;
  Registration registered(const std::vector<Slice>& slices, Filter filter) const;
  ScanStatus judge(const Match& found);
  /// The filter after the scan: with the update, with what a standstill tells, and, of a scan that
  /// is `tracked`, with a new calibration of the gyro.
  Filter correct(Registration found, const ScanImu& imu, bool tracked) const;
  /// The poses of the last scan, given what the filter has registered since; revises it.
  std::vector<StampedPose> revise(const Filter& filter);
  /// The world with the scan's points at these positions (m, LiDAR's frame at the filter's
  /// estimate), in the order of the points.
  static World with_points(World world, const Filter& filter, const Scan& scan,
                           std::vector<Eigen::Vector3f> positions);
  /// The same, unless the sensor has long stood still; without what is far.
  static World grown(World world, const Filter& filter, const Scan& scan,
                     const std::vector<Eigen::Vector3f>& positions);
  /// The first scan of an opening has no map to be matched with; the others have those before.
  Replay replay(const Opening& opening, Filter filter, World world) const;
  /// The estimate at the end of the opening's first scan that agrees best with the latest scan.
  estimation::StateEstimate reopened(const Opening& opening, const OpeningScan& latest,
                                     const Replay& before) const;

  Pose world_from_body(const World& world, const Filter& filter) const;
  /// By the gravity that the filter estimates.
  UpDirection up() const;
  /// The result with the filter as it is, and its pose for the trajectory.
  ScanResult finish_scan(Time begin, Time end, ScanStatus status, const ScanImu& imu,
                         std::size_t points, ScanDetails details);

  Config config_;
  Pose lidar_from_body_;            ///< as told: the body stays where the LiDAR is told to be on it
  Eigen::Matrix3d map_from_start_;  ///< rotation from the IMU's frame at the start to the map's
  Pose imu_from_lidar_;
  estimation::ImuNoise noise_;  ///< as told, with its factors
  Parallel parallel_;

  estimation::ImuBuffer imu_;
  estimation::MeasuredNoise measured_noise_;
  std::optional<Time> integrated_until_;  ///< by the LiDAR's clock; none until there are samples
  Time scan_duration_;                    ///< duration of the last scan that had points

  Start start_;
  Filter filter_;
  World world_;
  Tracking tracking_;
  LastScan last_;

  std::vector<StampedPose> poses_;  ///< of the body, in the world
  std::vector<Eigen::Vector3f> registered_scan_;
};

}  // namespace lidarena::odometry::arena_lio
