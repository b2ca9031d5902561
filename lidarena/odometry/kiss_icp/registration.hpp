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
/// (translation, rotation about the origin) of the point's pose (paper, eq. 10). All in m, map
/// frame.
struct PointResidual {
  Eigen::Vector3d error;
  Eigen::Matrix<double, 3, 6> jacobian;
};
PointResidual point_to_point(const Eigen::Vector3d& point, const Eigen::Vector3d& counterpart);

/// Geman-McClure weight of a residual as in the published program, which adds a length to a squared
/// length: the residual at which the weight is 1/4 is sqrt(scale / 1 m) m.
double kernel_weight(double squared_error, double scale);

/// Limits of one registration.
struct IcpLimits {
  double max_distance_m = 0.0;  ///< between a keypoint and its counterpart
  double kernel_scale = 0.0;    ///< see kernel_weight()
  int max_iterations = 0;
  double convergence = 0.0;  ///< ICP ends when the norm of its step (m, rad) is smaller
};
/// For the adaptive threshold's `sigma` (m): a search radius of 3 sigma (paper, section III-C).
IcpLimits icp_limits(double sigma, const Config& config);

struct Registration {
  Pose map_from_lidar = Pose::Identity();
  int iterations = 0;
  std::size_t matches = 0;  ///< keypoints with a counterpart, in the last iteration
};

/// Point-to-point ICP of the de-skewed `keypoints` against `map`, from the pose `guess` (paper,
/// section III-D).
Registration register_points(const Points& keypoints, const map::VoxelHashMap& map,
                             const Pose& guess, const IcpLimits& limits, const Parallel& parallel);

}  // namespace lidarena::odometry::kiss_icp
