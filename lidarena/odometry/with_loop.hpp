// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "lidarena/base/config.hpp"
#include "lidarena/base/parallel.hpp"
#include "lidarena/loop/anchored_trajectory.hpp"
#include "lidarena/loop/loop_closer.hpp"
#include "lidarena/odometry/odometry.hpp"

namespace lidarena {

struct WithLoopConfig {
  double keyframe_distance_m = 1.0;
  double keyframe_angle_rad = 0.5;
  double cloud_leaf_m = 0.1;
  LoopConfig loop = careful_loops();

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("keyframe_distance_m", self.keyframe_distance_m, "m", "moved so far, a scan is a keyframe",
      above(0));
    v("keyframe_angle_rad", self.keyframe_angle_rad, "rad", "turned so far, likewise", above(0));
    v("cloud_leaf_m", self.cloud_leaf_m, "m", "its points are averaged in cells of this edge",
      above(0));
    v("loop", self.loop, "", "how loops are found, judged and used");
  }
};

/// Loop closure around any odometry that publishes its scans: every so many meters a scan is kept,
/// and when the path comes back to one of them the path is bent. The odometry itself is left alone;
/// its live estimates are carried along by what the last loop asked for.
class WithLoop : public Odometry {
 public:
  WithLoop(std::unique_ptr<Odometry> odometry, const WithLoopConfig& config, Parallel parallel)
      : odometry_(std::move(odometry)),
        config_(config),
        closer_(config.loop, std::move(parallel)) {}

  OdometryTraits traits() const override;
  void register_imu(const ImuSample& sample) override { odometry_->register_imu(sample); }
  ScanResult register_scan(const Scan& scan) override;
  void finish() override { odometry_->finish(); }
  /// With all loops, those found later too.
  Trajectory trajectory() const override;
  /// The kept scans, as the loops have placed them.
  std::vector<Eigen::Vector3f> map() const override;
  std::map<std::string, std::uint64_t> memory() const override;

  const LoopCloser& loops() const { return closer_; }

 private:
  bool is_keyframe(const Pose& odom_from_body) const;
  void keep(Time stamp, const Pose& odom_from_body);

  std::unique_ptr<Odometry> odometry_;
  WithLoopConfig config_;
  LoopCloser closer_;
  Pose world_from_odom_ = Pose::Identity();
  Pose odom_from_keyframe_ = Pose::Identity();  ///< the last one
  std::vector<std::vector<Eigen::Vector3f>> clouds_;
  AnchoredTrajectory poses_;
};

}  // namespace lidarena
