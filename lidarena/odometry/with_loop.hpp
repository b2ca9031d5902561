// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "lidarena/base/config.hpp"
#include "lidarena/base/parallel.hpp"
#include "lidarena/loop/anchored_trajectory.hpp"
#include "lidarena/loop/loop_closer.hpp"
#include "lidarena/odometry/odometry.hpp"

namespace lidarena::odometry {

struct WithLoopConfig {
  double keyframe_translation_m = 1.0;
  double keyframe_rotation_rad = 0.5;
  double cloud_voxel_size_m = 0.1;
  loop::LoopConfig loop;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("keyframe_translation_m", self.keyframe_translation_m, "m",
      "a scan becomes a keyframe after this translation since the last one", above(0));
    v("keyframe_rotation_rad", self.keyframe_rotation_rad, "rad",
      "a scan becomes a keyframe after this rotation since the last one", above(0));
    v("cloud_voxel_size_m", self.cloud_voxel_size_m, "m",
      "voxel size for averaging a keyframe's points", above(0));
    v("loop", self.loop, "", "how loop candidates are found, verified and used");
  }
};

/// Loop closure around any odometry that publishes its scans: keyframes are kept at intervals, and
/// when the path returns to one of them, a pose graph corrects the trajectory. The odometry itself
/// is not changed; its live estimates are transformed by the correction of the last loop.
class WithLoop : public Odometry {
 public:
  WithLoop(std::unique_ptr<Odometry> odometry, const WithLoopConfig& config, Parallel parallel)
      : odometry_(std::move(odometry)),
        config_(config),
        closer_(config.loop, std::move(parallel)) {}

  OdometryTraits traits() const override;
  void register_imu(const ImuSample& sample) override { odometry_->register_imu(sample); }
  void finish() override { odometry_->finish(); }
  /// Poses corrected by all loops, including those found later than the pose.
  Trajectory trajectory() const override;
  /// Points of the keyframes at their corrected poses, m, world frame.
  std::vector<Eigen::Vector3f> map() const override;
  Pose leveled_from_world() const override { return odometry_->leveled_from_world(); }
  MemoryUse memory() const override;

  const loop::LoopCloser& loops() const { return closer_; }

 protected:
  ScanResult track(const Scan& scan) override;

 private:
  /// With all that is in the world moved by the loops.
  ScanResult corrected(ScanResult result) const;
  /// Relative to the last keyframe; as it is, as long as there is none.
  Pose in_keyframe(const Pose& odom_from_body) const;
  bool is_keyframe(const Pose& odom_from_body) const;
  /// The poses before the first keyframe, as the odometry has them once it has begun: a start in
  /// motion revises the poses of its first scans, which it calls initializing.
  void take_first_poses(Time until);
  void keep(Time stamp, const Pose& odom_from_body);
  /// Forgets the points of a keyframe at a place that an older one stands for, once loops tie the
  /// two visits: the memory follows the places that were seen, not the time.
  void retire_revisit();

  std::unique_ptr<Odometry> odometry_;
  WithLoopConfig config_;
  loop::LoopCloser closer_;
  // The odometry's world, in which loops change nothing, is `odom` here.
  Pose world_from_odom_ = Pose::Identity();
  Pose odom_from_keyframe_ = Pose::Identity();  ///< of the last keyframe
  std::vector<std::vector<Eigen::Vector3f>> clouds_;
  loop::AnchoredTrajectory poses_;
};

}  // namespace lidarena::odometry
