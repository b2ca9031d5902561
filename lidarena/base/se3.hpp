// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "lidarena/base/pose.hpp"

/// Rigid motions SE(3). A twist is (translation part rho [m], rotation part phi [rad]), in this
/// order. Conventions of Sola, Deray, Atchuthan (2018); Q block after Barfoot, "State Estimation
/// for Robotics" (2017), eq. 7.86.
namespace lidarena::se3 {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Pose of the twist `xi`: the rotation vector's rotation, and J_l(phi) * rho.
Pose exp(const Vector6& xi);
/// Twist of `pose`; rotation angle in [0, pi].
Vector6 log(const Pose& pose);
/// exp(xi + d) ~ exp(left_jacobian(xi) d) exp(xi).
Matrix6 left_jacobian(const Vector6& xi);
/// Inverse of left_jacobian; rotation angle < 2 pi.
Matrix6 left_jacobian_inverse(const Vector6& xi);
/// exp(xi + d) ~ exp(xi) exp(right_jacobian(xi) d).
inline Matrix6 right_jacobian(const Vector6& xi) { return left_jacobian(-xi); }
/// Inverse of right_jacobian; rotation angle < 2 pi.
inline Matrix6 right_jacobian_inverse(const Vector6& xi) { return left_jacobian_inverse(-xi); }

}  // namespace lidarena::se3
