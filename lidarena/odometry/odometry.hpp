// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lidarena/base/imu_sample.hpp"
#include "lidarena/base/scan.hpp"
#include "lidarena/base/trajectory.hpp"

namespace lidarena::odometry {

enum class ScanStatus {
  kTracked,       ///< the estimate was updated with this scan
  kInitializing,  ///< first scan or IMU alignment; the estimate is provisional
  kDegenerate,    ///< at least one direction was not observable
  kTooFewPoints,  ///< nothing usable in the scan; the estimate is a prediction
  kDiverged,      ///< the estimate must not be used
};
const char* to_string(ScanStatus status);

/// What a method counted in one scan. A method leaves unset what it does not have.
struct ScanCounters {
  using Count = std::optional<std::uint64_t>;
  Count points{};                 ///< within the range limits
  Count keypoints{};              ///< points or features that were registered
  Count matches{};                ///< of these, with a counterpart in the map
  Count near_planes{};            ///< of these, with a plane nearby, whether they lie on it or not
  Count edges{};                  ///< edge features found
  Count surfaces{};               ///< surface features found
  Count iterations{};             ///< of the registration or the filter's update
  Count degenerate_directions{};  ///< of 6 that the scan does not determine
  Count map_points{};
  Count keyframes{};
  Count loops{};                   ///< accepted so far
  Count loops_tried{};             ///< verified so far, accepted or not
  Count imu_saturated{};           ///< intervals of this scan with a sample at the end of its range
  Count imu_refused{};             ///< samples so far that were out of order or not finite
  Count imu_restarts{};            ///< of the inertial estimate so far
  Count scans_refused{};           ///< so far, out of order
  std::optional<bool> inserted{};  ///< the scan was added to the map
  std::optional<bool> standing{};  ///< the sensor stands still
  std::optional<double> threshold_m{};    ///< scale of the prediction's error
  std::optional<double> imu_gap_s{};      ///< longest time without samples in this scan
  std::optional<double> imu_delay_s{};    ///< by how much the IMU's stamps are late, by the LiDAR's
  std::optional<double> lidar_moved_m{};  ///< of the LiDAR, from where it is told to be, by the IMU
  std::optional<double> lidar_turned_rad{};  ///< likewise
  std::optional<double> accel_scale{};       ///< factor from the IMU's accelerations to m/s^2

  /// Calls v(name, field) for each field.
  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("points", self.points);
    v("keypoints", self.keypoints);
    v("matches", self.matches);
    v("near_planes", self.near_planes);
    v("edges", self.edges);
    v("surfaces", self.surfaces);
    v("iterations", self.iterations);
    v("degenerate_directions", self.degenerate_directions);
    v("map_points", self.map_points);
    v("keyframes", self.keyframes);
    v("loops", self.loops);
    v("loops_tried", self.loops_tried);
    v("imu_saturated", self.imu_saturated);
    v("imu_refused", self.imu_refused);
    v("imu_restarts", self.imu_restarts);
    v("scans_refused", self.scans_refused);
    v("inserted", self.inserted);
    v("standing", self.standing);
    v("threshold_m", self.threshold_m);
    v("imu_gap_s", self.imu_gap_s);
    v("imu_delay_s", self.imu_delay_s);
    v("lidar_moved_m", self.lidar_moved_m);
    v("lidar_turned_rad", self.lidar_turned_rad);
    v("accel_scale", self.accel_scale);
  }
};

/// Result of one scan.
struct ScanResult {
  StampedPose estimate;  ///< world_from_body and the instant at which it holds
  ScanStatus status = ScanStatus::kTracked;
  std::optional<Eigen::Matrix<double, 6, 6>> covariance;  ///< of (translation, rotation), if known
  ScanCounters counters;
  /// Poses within the scan, if the method estimates or assumes them; for de-skewing by others.
  std::vector<StampedPose> motion;
  /// Such poses of the scan before, given this scan as well, if the method revises them: the last
  /// one is its pose in trajectory() from now on.
  std::vector<StampedPose> revised{};
};

struct OdometryTraits {
  bool needs_imu = false;
  bool revises_past = false;     ///< trajectory() after finish() differs from the live estimates
  bool gravity_aligned = false;  ///< its world frame has z up
  /// True: the map is made of the published scans, see registered_scan(); false: it is map().
  bool publishes_scans = true;
  std::string pose_frame = "body";
};

/// A LiDAR(-inertial) odometry. Built from configuration and rig by the factory. It receives only
/// events and has no access to the world, the flight or the ground truth. Its world frame is the
/// body frame at the start (leveled, so that z points up, if gravity_aligned).
class Odometry {
 public:
  virtual ~Odometry() = default;
  virtual OdometryTraits traits() const = 0;
  /// Samples come in time order, and before the scan during which they were taken. LiDAR-only
  /// methods ignore them.
  virtual void register_imu(const ImuSample&) {}
  virtual ScanResult register_scan(const Scan& scan) = 0;
  /// Call after the last event: flushes smoothers and closes the last loops.
  virtual void finish() {}
  /// Best estimate of all poses so far.
  virtual Trajectory trajectory() const = 0;
  /// The method's own map, world frame, m.
  virtual std::vector<Eigen::Vector3f> map() const = 0;
  /// The last scan as the method publishes it: de-skewed, world frame, m. Valid until the next
  /// call.
  virtual std::span<const Eigen::Vector3f> registered_scan() const { return {}; }
  /// From the body's frame at the start to the world frame of the last result. It changes while a
  /// gravity_aligned method learns where up is; trajectory(), map() and registered_scan() are in
  /// the last world.
  virtual Pose world_from_start() const { return Pose::Identity(); }
  /// Bytes held by part: "map", "scan_buffer", "backlog", "other".
  virtual std::map<std::string, std::uint64_t> memory() const = 0;
};

}  // namespace lidarena::odometry
