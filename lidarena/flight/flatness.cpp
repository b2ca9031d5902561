// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/flatness.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace lidarena::flight {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Vector3d thrust_of(const Vector3d& acceleration) {
  return acceleration + kGravity * Vector3d::UnitZ();
}

/// Shortest rotation from the z axis to the unit vector `z`.
Matrix3d tilt_of(const Vector3d& z) {
  const double k = 1.0 / (1.0 + z.z());
  const double xy = -k * z.x() * z.y();
  Matrix3d tilt;
  tilt << 1.0 - k * z.x() * z.x(), xy, z.x(),  //
      xy, 1.0 - k * z.y() * z.y(), z.y(),      //
      -z.x(), -z.y(), z.z();
  return tilt;
}

Matrix3d turned(const Matrix3d& tilt, double c, double s) {
  Matrix3d r;
  r << c * tilt.col(0) + s * tilt.col(1), c * tilt.col(1) - s * tilt.col(0), tilt.col(2);
  return r;
}

/// A unit vector and its first and second time derivatives.
struct Direction {
  Vector3d value, rate, acceleration;
};

/// The direction of a vector `f` with first derivative `df` and second derivative `ddf`.
Direction direction_of(const Vector3d& f, const Vector3d& df, const Vector3d& ddf) {
  const double n = f.norm();
  const Vector3d z = f / n;
  const double dn = z.dot(df);
  const Vector3d dz = (df - dn * z) / n;
  const double ddn = dz.dot(df) + z.dot(ddf);
  return {z, dz, (ddf - 2.0 * dn * dz - ddn * z) / n};
}

/// Angular rate of tilt_of(z), in the rotated frame, and its time derivative.
struct TiltRate {
  Vector3d value, rate;
};

TiltRate tilt_rate_of(const Direction& z) {
  const auto& [e, d, dd] = z;
  const double k = 1.0 / (1.0 + e.z());
  const double u = k * d.z();
  const double du = k * dd.z() - u * u;
  return {{u * e.y() - d.y(), d.x() - u * e.x(), k * (e.y() * d.x() - e.x() * d.y())},
          {du * e.y() + u * d.y() - dd.y(), dd.x() - du * e.x() - u * d.x(),
           k * (e.y() * dd.x() - e.x() * dd.y()) - k * u * (e.y() * d.x() - e.x() * d.y())}};
}

}  // namespace

Matrix3d attitude_of(const Vector3d& acceleration, double yaw) {
  return turned(tilt_of(thrust_of(acceleration).normalized()), std::cos(yaw), std::sin(yaw));
}

Motion motion_of(const FlatOutputs& outputs) {
  const Vector3d acceleration = outputs[2].head<3>();
  const Direction z =
      direction_of(thrust_of(acceleration), outputs[3].head<3>(), outputs[4].head<3>());
  const TiltRate tilt_rate = tilt_rate_of(z);
  const double c = std::cos(outputs[0].w());
  const double s = std::sin(outputs[0].w());
  const double yaw_rate = outputs[1].w();
  const auto to_body = [&](const Vector3d& v) {
    return Vector3d(c * v.x() + s * v.y(), c * v.y() - s * v.x(), v.z());
  };
  const Vector3d turned_rate = to_body(tilt_rate.value);

  Motion motion;
  motion.world_from_body = make_pose(turned(tilt_of(z.value), c, s), outputs[0].head<3>());
  motion.velocity_world = outputs[1].head<3>();
  motion.acceleration_world = acceleration;
  motion.angular_rate_body = turned_rate + yaw_rate * Vector3d::UnitZ();
  motion.angular_acceleration_body = to_body(tilt_rate.rate) -
                                     yaw_rate * Vector3d::UnitZ().cross(turned_rate) +
                                     outputs[2].w() * Vector3d::UnitZ();
  return motion;
}

}  // namespace lidarena::flight
