// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/base/se3.hpp"

#include <cmath>

#include "lidarena/base/so3.hpp"

namespace lidarena::se3 {
namespace {

/// Barfoot's Q(rho, phi), the coupling block of the left Jacobian.
Eigen::Matrix3d coupling(const Eigen::Vector3d& rho, const Eigen::Vector3d& phi) {
  const Eigen::Matrix3d r = so3::hat(rho);
  const Eigen::Matrix3d p = so3::hat(phi);
  const double t2 = phi.squaredNorm();
  const double t = std::sqrt(t2);
  double a;       // (t - sin t) / t^3
  double b;       // (t^2 + 2 cos t - 2) / (2 t^4)
  double c;       // (2 t - 3 sin t + t cos t) / (2 t^5)
  if (t < 0.1) {  // quotients of canceling terms: series, first dropped term under 1e-14
    a = 1.0 / 6.0 - t2 / 120.0 + t2 * t2 / 5040.0 - t2 * t2 * t2 / 362880.0;
    b = 1.0 / 24.0 - t2 / 720.0 + t2 * t2 / 40320.0 - t2 * t2 * t2 / 3628800.0;
    c = 1.0 / 120.0 - t2 / 2520.0 + t2 * t2 / 120960.0 - t2 * t2 * t2 / 9979200.0;
  } else {
    const double s = std::sin(t);
    const double k = std::cos(t);
    a = (t - s) / (t2 * t);
    b = (t2 + 2.0 * k - 2.0) / (2.0 * t2 * t2);
    c = (2.0 * t - 3.0 * s + t * k) / (2.0 * t2 * t2 * t);
  }
  return 0.5 * r + a * (p * r + r * p + p * r * p) + b * (p * p * r + r * p * p - 3.0 * p * r * p) +
         c * (p * r * p * p + p * p * r * p);
}

}  // namespace

Pose exp(const Vector6& xi) {
  return make_pose(so3::exp(xi.tail<3>()), so3::left_jacobian(xi.tail<3>()) * xi.head<3>());
}

Vector6 log(const Pose& pose) {
  Vector6 xi;
  xi.tail<3>() = so3::log(pose.linear());
  xi.head<3>() = so3::left_jacobian_inverse(xi.tail<3>()) * pose.translation();
  return xi;
}

Matrix6 left_jacobian(const Vector6& xi) {
  Matrix6 m = Matrix6::Zero();
  m.topLeftCorner<3, 3>() = so3::left_jacobian(xi.tail<3>());
  m.bottomRightCorner<3, 3>() = m.topLeftCorner<3, 3>();
  m.topRightCorner<3, 3>() = coupling(xi.head<3>(), xi.tail<3>());
  return m;
}

Matrix6 left_jacobian_inverse(const Vector6& xi) {
  const Eigen::Matrix3d inverse = so3::left_jacobian_inverse(xi.tail<3>());
  Matrix6 m = Matrix6::Zero();
  m.topLeftCorner<3, 3>() = inverse;
  m.bottomRightCorner<3, 3>() = inverse;
  m.topRightCorner<3, 3>() = -inverse * coupling(xi.head<3>(), xi.tail<3>()) * inverse;
  return m;
}

}  // namespace lidarena::se3
