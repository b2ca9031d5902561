// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/base/pose.hpp"
#include "lidarena/base/se3.hpp"
#include "lidarena/base/so3.hpp"

/// Twists and poses from their six numbers: translation, then rotation vector.
namespace lidarena::odometry::kiss_icp {

inline se3::Vector6 vector6(double a, double b, double c, double d, double e, double f) {
  se3::Vector6 v;
  v << a, b, c, d, e, f;
  return v;
}

inline Pose pose_of(double x, double y, double z, double rx, double ry, double rz) {
  return make_pose(so3::exp({rx, ry, rz}), {x, y, z});
}

}  // namespace lidarena::odometry::kiss_icp
