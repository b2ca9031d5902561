// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

/// The rotation group SO(3). Conventions of Sola, Deray, Atchuthan, "A micro Lie theory for state
/// estimation in robotics" (2018): tangent vectors are rotation vectors in rad.
namespace lidarena::so3 {

using Matrix3 = Eigen::Matrix3d;
using Vector3 = Eigen::Vector3d;

/// Skew matrix: hat(a) * b == a.cross(b).
Matrix3 hat(const Vector3& v);
/// Rotation matrix of the rotation vector `v` (Rodrigues).
Matrix3 exp(const Vector3& v);
/// Rotation vector of `r`, length in [0, pi]; accurate near 0 and near pi.
Vector3 log(const Matrix3& r);
/// Angle of `r` in [0, pi], computed with atan2, so that 1e-9 rad is still resolved.
double angle(const Matrix3& r);
/// exp(v + d) ~ exp(left_jacobian(v) * d) * exp(v).
Matrix3 left_jacobian(const Vector3& v);
/// Inverse of left_jacobian; |v| < 2 pi.
Matrix3 left_jacobian_inverse(const Vector3& v);
/// exp(v + d) ~ exp(v) * exp(right_jacobian(v) * d).
inline Matrix3 right_jacobian(const Vector3& v) { return left_jacobian(-v); }
/// Inverse of right_jacobian; |v| < 2 pi.
inline Matrix3 right_jacobian_inverse(const Vector3& v) { return left_jacobian_inverse(-v); }

}  // namespace lidarena::so3
