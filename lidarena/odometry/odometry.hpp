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

/// Result of one scan.
struct ScanResult {
  StampedPose estimate;  ///< world_from_body and the instant at which it holds
  ScanStatus status = ScanStatus::kTracked;
  std::optional<Eigen::Matrix<double, 6, 6>> covariance;  ///< of (translation, rotation), if known
  std::map<std::string, double> counters;  ///< iterations, inliers, edges, planes, loops, ...
  /// Poses within the scan, if the method estimates or assumes them; for de-skewing by others.
  std::vector<StampedPose> motion;
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
  /// Bytes held by part: "map", "scan_buffer", "backlog", "other".
  virtual std::map<std::string, std::uint64_t> memory() const = 0;
};

}  // namespace lidarena::odometry
