// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/base/so3.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace lidarena::so3 {
namespace {

// Below this squared angle the trigonometric quotients are replaced by their Taylor series, whose
// first dropped term is then under 1e-16.
constexpr double kSmallSquared = 1e-4;

/// sin(t) / t
double sinc(double t2) {
  if (t2 < kSmallSquared) return 1.0 - t2 / 6.0 * (1.0 - t2 / 20.0 * (1.0 - t2 / 42.0));
  const double t = std::sqrt(t2);
  return std::sin(t) / t;
}

/// (1 - cos(t)) / t^2
double cosc(double t2) {
  if (t2 < kSmallSquared) return 0.5 * (1.0 - t2 / 12.0 * (1.0 - t2 / 30.0 * (1.0 - t2 / 56.0)));
  return (1.0 - std::cos(std::sqrt(t2))) / t2;
}

/// (t - sin(t)) / t^3
double sincc(double t2) {
  if (t2 < kSmallSquared) {
    return 1.0 / 6.0 * (1.0 - t2 / 20.0 * (1.0 - t2 / 42.0 * (1.0 - t2 / 72.0)));
  }
  const double t = std::sqrt(t2);
  return (t - std::sin(t)) / (t2 * t);
}

}  // namespace

Matrix3 hat(const Vector3& v) {
  Matrix3 m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

Matrix3 exp(const Vector3& v) {
  const double t2 = v.squaredNorm();
  const Matrix3 k = hat(v);
  return Matrix3::Identity() + sinc(t2) * k + cosc(t2) * k * k;
}

Vector3 log(const Matrix3& r) {
  Eigen::Quaterniond q(r);
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  const double n = q.vec().norm();
  if (n < 1e-10) return 2.0 * q.vec() / q.w();
  return 2.0 * std::atan2(n, q.w()) / n * q.vec();
}

double angle(const Matrix3& r) {
  const Eigen::Quaterniond q(r);
  return 2.0 * std::atan2(q.vec().norm(), std::abs(q.w()));
}

Matrix3 left_jacobian(const Vector3& v) {
  const double t2 = v.squaredNorm();
  const Matrix3 k = hat(v);
  return Matrix3::Identity() + cosc(t2) * k + sincc(t2) * k * k;
}

Matrix3 left_jacobian_inverse(const Vector3& v) {
  const double t2 = v.squaredNorm();
  const Matrix3 k = hat(v);
  // (1/t^2) (1 - t sin t / (2 (1 - cos t))) tends to 1/12
  const double c = t2 < kSmallSquared ? 1.0 / 12.0 * (1.0 + t2 / 60.0 * (1.0 + t2 / 42.0))
                                      : (1.0 - 0.5 * sinc(t2) / cosc(t2)) / t2;
  return Matrix3::Identity() - 0.5 * k + c * k * k;
}

}  // namespace lidarena::so3
