// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/pose.hpp"
#include "lidarena/map/voxel_hash_map.hpp"
#include "lidarena/odometry/kiss_icp/config.hpp"
#include "lidarena/odometry/kiss_icp/preprocess.hpp"

namespace lidarena::odometry::kiss_icp {

/// Difference of a point and its counterpart, and its derivative with respect to a left increment
/// (translation, rotation about `center`) of the point's pose (paper, eq. 10). All in m, map frame.
struct PointResidual {
  Eigen::Vector3d error;
  Eigen::Matrix<double, 3, 6> jacobian;
};
PointResidual point_to_point(const Eigen::Vector3d& point, const Eigen::Vector3d& counterpart,
                             const Eigen::Vector3d& center);

/// The pose previous to the scan's.
struct PreviousPose {
  Pose map_from_lidar = Pose::Identity();
  double seconds = 0.0;                       ///< from that pose's instant to this one's
  se3::Vector6 twist = se3::Vector6::Zero();  ///< m/s, rad/s, of the lidar up to that pose
};

struct Registration {
  Pose map_from_lidar = Pose::Identity();
  int iterations = 0;
  se3::Vector6 twist = se3::Vector6::Zero();  ///< m/s, rad/s, with which keypoints were de-skewed
  std::size_t matches = 0;  ///< keypoints with a counterpart, in the last iteration
};

/// Point-to-point ICP of `keypoints` against `map`, from the pose `guess`, with search radius
/// 3 sigma (paper, section III-D). Keypoints that are not yet de-skewed are de-skewed in each
/// iteration with twist_towards() the current estimate; their Jacobians are scaled by the share of
/// the pose increment that this gives to their instants.
Registration register_points(const TimedPoints& keypoints, const map::VoxelHashMap& map,
                             const PreviousPose& previous_pose, const Pose& guess, double sigma,
                             double scan_motion_share, const Config& config,
                             const Parallel& parallel);

/// Twist within a scan that ends at `map_from_lidar`: `scan_motion_share` times the mean twist
/// since `previous_pose`, plus (1 - `scan_motion_share`) times the twist before it.
se3::Vector6 twist_towards(const Pose& map_from_lidar, const PreviousPose& previous_pose,
                           double scan_motion_share);

}  // namespace lidarena::odometry::kiss_icp
