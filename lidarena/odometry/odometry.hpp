// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
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
  kRefused,       ///< the scan is not later than the one before; nothing changed
};
const char* to_string(ScanStatus status);

/// What a run records as events, see stages::EventRecord. A method leaves unset what it lacks.
struct ScanCounters {
  using Count = std::optional<std::uint64_t>;
  Count points{};                 ///< within the range limits
  Count degenerate_directions{};  ///< of 6 that the scan does not determine
  Count imu_saturated{};          ///< intervals of this scan with a sample at the end of its range
  Count imu_restarts{};           ///< of the inertial estimate so far
  Count loops{};                  ///< accepted so far

  /// Calls v(name, field) for each field.
  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("points", self.points);
    v("degenerate_directions", self.degenerate_directions);
    v("imu_saturated", self.imu_saturated);
    v("imu_restarts", self.imu_restarts);
    v("loops", self.loops);
  }
};

/// What else a method says of a scan: names and values, see the method's README.
using ScanDetails = std::vector<std::pair<std::string, double>>;

/// What is known of the vertical.
struct UpDirection {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit vector, world frame
  double sigma_rad = 0.0;                                ///< standard deviation of its angle
};

/// Result of one scan. All poses are in the run's world.
struct ScanResult {
  StampedPose estimate;  ///< world_from_body and the instant at which it holds
  ScanStatus status = ScanStatus::kTracked;
  /// Of (translation, rotation), if known: m along the world's axes, rad about the body's.
  std::optional<Eigen::Matrix<double, 6, 6>> covariance{};
  ScanCounters counters{};
  /// Poses within the scan, if the method estimates or assumes them; for de-skewing by others.
  std::vector<StampedPose> motion{};
  /// Such poses of the scan before, given this scan as well, if the method revises them: the last
  /// one is its pose in trajectory() from now on.
  std::vector<StampedPose> revised{};
  std::optional<UpDirection> up{};  ///< by this scan, of a gravity_aligned method
  /// By how much loops have moved the estimate: world_from_odom^-1 * world_from_body is continuous
  /// from scan to scan.
  Pose world_from_odom = Pose::Identity();
  ScanDetails details{};

  /// The detail of this name, if the method gave it.
  std::optional<double> detail(std::string_view name) const;
};

struct OdometryTraits {
  bool needs_imu = false;
  bool revises_past = false;     ///< trajectory() after finish() differs from the live estimates
  bool gravity_aligned = false;  ///< its world has z up, as far as known at the initialization
  /// True: the map is made of the published scans, see registered_scan(); false: it is map().
  bool publishes_scans = false;
  std::string pose_frame = "body";
};

/// Bytes that a method holds, by part.
struct MemoryUse {
  std::uint64_t map = 0;
  std::uint64_t scan_buffer = 0;
  std::uint64_t backlog = 0;  ///< measurements that wait to be used
  std::uint64_t other = 0;
};

/// A LiDAR(-inertial) odometry. Built from configuration and rig by the factory. It receives only
/// events and has no access to the world, the flight or the ground truth. Its world frame stands
/// still during a run: the body frame at the start, leveled at the initialization by what is known
/// then, if it is gravity_aligned.
class Odometry {
 public:
  virtual ~Odometry() = default;
  virtual OdometryTraits traits() const = 0;
  /// Samples come in time order, and before the scan during which they were taken. LiDAR-only
  /// methods ignore them.
  virtual void register_imu(const ImuSample&) {}
  /// Registers a scan, unless its first or its last point is not later than that of the scan
  /// before. Such a scan is refused and counted; the result is the estimate before, kRefused.
  ScanResult register_scan(const Scan& scan);
  std::uint64_t scans_refused() const { return scans_refused_; }
  /// Call after the last event: flushes smoothers and closes the last loops.
  virtual void finish() {}
  /// Best estimate of all poses so far.
  virtual Trajectory trajectory() const = 0;
  /// The method's own map, world frame, m.
  virtual std::vector<Eigen::Vector3f> map() const = 0;
  /// The last scan as the method publishes it: de-skewed, world frame, m. Valid until the next
  /// call.
  virtual std::span<const Eigen::Vector3f> registered_scan() const { return {}; }
  /// A rotation that levels the world by all that is known of up; after finish(). The runner
  /// applies it to the final trajectory and to the map.
  virtual Pose leveled_from_world() const { return Pose::Identity(); }
  virtual MemoryUse memory() const = 0;

 protected:
  /// Estimates the pose of a scan that is later than the one before.
  virtual ScanResult track(const Scan& scan) = 0;

 private:
  std::optional<Time> last_begin_, last_end_;  ///< first and last point of the last scan
  StampedPose last_estimate_;
  std::uint64_t scans_refused_ = 0;
};

}  // namespace lidarena::odometry
