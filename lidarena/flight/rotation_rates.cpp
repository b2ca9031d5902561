// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/rotation_rates.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace lidarena::flight {
namespace {

using Eigen::Vector3d;

/// b = (1 - cos t) / t^2, c = (t - sin t) / t^3 of the right Jacobian I - b [v] + c [v]^2 (Sola,
/// Deray, Atchuthan 2018, eq. 143), and their derivatives with respect to x = t^2.
struct Quotients {
  double b, c, db, dc;
};

Quotients quotients(double x) {
  // Below this value the closed forms suffer from cancellation; the first neglected terms of the
  // series are below 1e-16 of the sum.
  if (x < 1e-2) {
    return {1.0 / 2 - x * (1.0 / 24 - x * (1.0 / 720 - x * (1.0 / 40320 - x / 3628800))),
            1.0 / 6 - x * (1.0 / 120 - x * (1.0 / 5040 - x * (1.0 / 362880 - x / 39916800))),
            -1.0 / 24 + x * (2.0 / 720 - x * (3.0 / 40320 - x * (4.0 / 3628800))),
            -1.0 / 120 + x * (2.0 / 5040 - x * (3.0 / 362880 - x * (4.0 / 39916800)))};
  }
  const double t = std::sqrt(x);
  const double sinc = std::sin(t) / t;
  const double b = (1.0 - std::cos(t)) / x;
  const double c = (1.0 - sinc) / x;
  return {b, c, (0.5 * sinc - b) / x, (0.5 * b - 1.5 * c) / x};
}

}  // namespace

Vector3d body_rate(const Vector3d& v, const Vector3d& dv) {
  const Quotients q = quotients(v.squaredNorm());
  const Vector3d v_cross_dv = v.cross(dv);
  return dv - q.b * v_cross_dv + q.c * v.cross(v_cross_dv);
}

Vector3d body_acceleration(const Vector3d& v, const Vector3d& dv, const Vector3d& ddv) {
  const Quotients q = quotients(v.squaredNorm());
  const double dx = 2.0 * v.dot(dv);
  const Vector3d v_cross_dv = v.cross(dv);
  const Vector3d v_cross_ddv = v.cross(ddv);
  return ddv - q.db * dx * v_cross_dv - q.b * v_cross_ddv + q.dc * dx * v.cross(v_cross_dv) +
         q.c * (dv.cross(v_cross_dv) + v.cross(v_cross_ddv));
}

}  // namespace lidarena::flight
