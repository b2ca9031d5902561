// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/pose.hpp"
#include "lidarena/base/scan.hpp"
#include "lidarena/base/se3.hpp"

namespace lidarena::estimation {

/// Motion with a constant body twist (m/s, rad/s): after t seconds the pose is exp(t * twist). The
/// coefficients of the closed form are computed once, so that a pose costs one sine and one cosine.
class ConstantTwist {
 public:
  explicit ConstantTwist(const se3::Vector6& twist_per_second);
  /// exp(seconds * twist).
  Pose at(double seconds) const;

 private:
  se3::Vector6 twist_;
  double rate_;             ///< rad/s
  Eigen::Vector3d axis_;    ///< unit, of the rotation
  Eigen::Vector3d along_;   ///< m/s, velocity along the axis
  Eigen::Vector3d across_;  ///< m, velocity across the axis / rate
  Eigen::Vector3d turned_;  ///< m, axis x velocity / rate
  Eigen::Matrix3d skew_;    ///< hat(axis)
  Eigen::Matrix3d skew_squared_;
};

/// Positions (m) of all points of `scan`, in order, in the lidar frame at time `reference`, for a
/// lidar that moves with the constant `twist_per_second` (m/s, rad/s, lidar frame). Untimed scans
/// are returned unchanged; points that are not finite stay so.
std::vector<Eigen::Vector3f> deskew(const Scan& scan, const se3::Vector6& twist_per_second,
                                    Time reference, const Parallel& parallel);

/// The positions as measured, without de-skewing.
std::vector<Eigen::Vector3f> positions(const Scan& scan);

}  // namespace lidarena::estimation
