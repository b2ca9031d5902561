// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/pose.hpp"
#include "lidarena/map/voxel_hash_map.hpp"
#include "lidarena/odometry/kiss_icp/config.hpp"

namespace lidarena::kiss_icp {

/// Error of a point against its counterpart, and its derivative by a left increment
/// (translation, rotation about `center`) of the point's pose (paper, eq. 10).
struct PointResidual {
  Eigen::Vector3d error;
  Eigen::Matrix<double, 3, 6> jacobian;
};
PointResidual point_to_point(const Eigen::Vector3d& point, const Eigen::Vector3d& counterpart,
                             const Eigen::Vector3d& center);

struct Registration {
  Pose map_from_lidar = Pose::Identity();
  int iterations = 0;
  std::size_t matches = 0;  ///< keypoints with a counterpart, in the last iteration
};

/// Point-to-point ICP of `keypoints` (lidar frame, m) against `map`, from the pose `guess`, with
/// search radius 3 sigma (paper, section III-D).
Registration register_points(std::span<const Eigen::Vector3f> keypoints, const VoxelHashMap& map,
                             const Pose& guess, double sigma, const Config& config,
                             const Parallel& parallel);

}  // namespace lidarena::kiss_icp
