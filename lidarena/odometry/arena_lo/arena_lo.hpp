// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/rig.hpp"
#include "lidarena/estimation/motion_filter.hpp"
#include "lidarena/estimation/scan_times.hpp"
#include "lidarena/map/local_planes.hpp"
#include "lidarena/odometry/arena_lo/config.hpp"
#include "lidarena/odometry/arena_lo/registration.hpp"
#include "lidarena/odometry/arena_lo/slices.hpp"
#include "lidarena/odometry/odometry.hpp"
#include "lidarena/odometry/tracking.hpp"

namespace lidarena::odometry::arena_lo {

/// LiDAR odometry: a Kalman smoother follows the motion within a scan from slice to slice, by the
/// distances of points from a map of planes. See README.md in this folder.
class ArenaLo : public Odometry {
 public:
  ArenaLo(const Config& config, const LidarInfo& lidar, Parallel parallel);

  OdometryTraits traits() const override { return {.revises_past = true, .publishes_scans = true}; }
  Trajectory trajectory() const override { return Trajectory(poses_, "arena_lo"); }
  std::vector<Eigen::Vector3f> map() const override;
  std::span<const Eigen::Vector3f> registered_scan() const override { return registered_scan_; }
  MemoryUse memory() const override;

 protected:
  ScanResult track(const Scan& scan) override;

 private:
  /// The first scan of the map, which is placed again once the second shows the velocity.
  struct Opening {
    std::vector<Slice> slices;  ///< a single one
    Known known;                ///< at its middle
    Time end{0};
  };

  /// The filter's steps through a scan.
  struct ScanSteps {
    estimation::ScanTimes times;
    std::vector<Time> instants;  ///< of the steps: the slices' middles, the scan's end
    Steps steps;
  };

  /// The first and the second scan are single slices: motions within them are not known yet.
  double slice_duration(const estimation::ScanTimes& times) const;
  /// Finds the velocity between the middles of the first two scans, by which both are de-skewed:
  /// registers the second against the first, places the first by the velocity that follows, and so
  /// on. With a wrong velocity both are smeared alike about their middles, so that one converges.
  void begin_again(const std::vector<Slice>& second, Time end);
  /// The scan against the map; the first one, which has none, stands still at the origin.
  Registration align(const std::vector<Slice>& slices, Time end) const;
  ScanStatus status_of(const Registration& found, std::size_t points);
  /// Whether a scan with this status enters the map.
  bool is_used(ScanStatus status) const;
  /// The last motion, which continues, but slows down.
  Steps coasted(const std::vector<Slice>& slices, Time end) const;
  /// The motion of the scan before, given that of this scan as well, if it was already registered
  /// against the map; its last pose becomes that of the trajectory.
  std::vector<StampedPose> revise(const Steps& steps, const Motion& motion);
  void advance(const std::vector<Slice>& slices, const Steps& steps,
               const estimation::ScanTimes& times);
  void grow_map(const std::vector<Eigen::Vector3f>& points);

  std::vector<Eigen::Vector3f> points_in_map(const std::vector<Slice>& slices,
                                             const Motion& motion) const;
  /// Poses of the body at the scan's begin, if points have times, and at the instants of `motion`.
  std::vector<StampedPose> poses_within(const ScanSteps& scan, const Motion& motion) const;
  StampedPose body_pose(Time instant, const Pose& map_from_lidar) const;

  Config config_;
  Pose body_from_lidar_;
  Parallel parallel_;

  Known known_;     ///< of the lidar at the end of the last scan; map: its frame at the first scan
  ScanSteps last_;  ///< how it came to that
  map::LocalPlanes map_;
  std::optional<Opening> opening_;  ///< from the first scan to the second
  std::size_t scans_mapped_ = 0;
  Tracking tracking_;

  std::vector<StampedPose> poses_;
  std::vector<Eigen::Vector3f> registered_scan_;
  Time scan_duration_;  ///< of the last scan that had times
};

}  // namespace lidarena::odometry::arena_lo
