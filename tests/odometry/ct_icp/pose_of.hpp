// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/base/pose.hpp"
#include "lidarena/base/so3.hpp"

namespace lidarena::odometry::ct_icp {

/// The pose with this position (m) and rotation vector (rad).
inline Pose pose_of(double x, double y, double z, double rx, double ry, double rz) {
  return make_pose(so3::exp({rx, ry, rz}), {x, y, z});
}

}  // namespace lidarena::odometry::ct_icp
