// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/pose.hpp"
#include "lidarena/base/scan.hpp"
#include "lidarena/base/trajectory.hpp"

namespace lidarena::estimation {

/// Motion over one IMU step: rate and acceleration constant from `begin` to the next step's begin.
struct ImuStep {
  Time begin{0};
  Pose world_from_imu = Pose::Identity();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();      ///< m/s, world
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  ///< m/s^2, world, without gravity
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();          ///< rad/s, body
};

/// The steps of one scan, in time order.
using ImuTrack = std::vector<ImuStep>;

/// Pose at `t`, extrapolated from the last step that begins at or before it, or from the first step
/// if all begin later. `track` must not be empty.
Pose pose_at(const ImuTrack& track, Time t);

/// The track bent so that its pose at `end` becomes `world_from_imu_at_end`, while that at its
/// begin stays: an estimate corrects the motion that was predicted since the previous one, and each
/// instant gets the share of the correction that has accumulated until then (both of translation
/// and rotation in proportion to time). Unchanged if it is empty or begins at `end` or later.
ImuTrack bent_track(ImuTrack track, Time end, const Pose& world_from_imu_at_end);

/// Poses of a body from `begin` to `end`, at both and at the begin of each step between them. The
/// track gives the motion relative to the instant `at`, at which the pose is `world_from_imu_at`.
/// Empty if `track` is empty or unless begin < end.
std::vector<StampedPose> motion_along(const ImuTrack& track, Time begin, Time end, Time at,
                                      const Pose& world_from_imu_at, const Pose& imu_from_body);

/// Positions (m) of all points of `scan`, in order, in the LiDAR frame at the instant of
/// `world_from_imu_at_end` (FAST-LIO2's backward propagation, eq. 10, with the relative poses of
/// the forward propagation). Untimed scans are returned unchanged; points that are not finite stay
/// so.
std::vector<Eigen::Vector3f> deskew(const Scan& scan, const ImuTrack& track,
                                    const Pose& imu_from_lidar, const Pose& world_from_imu_at_end,
                                    const Parallel& parallel);

}  // namespace lidarena::estimation
