// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "lidarena/base/pose.hpp"

/// Distances (m) along a ray from `origin` in the unit direction `direction` to simple bodies, from
/// outside or inside; infinite where the ray misses. Written without the library's ray casters.
namespace lidarena::gz_sim_test {

using Eigen::Vector3d;
using Distance = std::function<double(const Vector3d& origin, const Vector3d& direction)>;

constexpr double kMissed = std::numeric_limits<double>::infinity();

inline double positive(double t) { return t > 0.0 ? t : kMissed; }

/// The plane z = height.
inline Distance plane_at(double height) {
  return [=](const Vector3d& origin, const Vector3d& direction) {
    return positive((height - origin.z()) / direction.z());
  };
}

/// The smaller positive root of |o + t d| = radius, for vectors of two or three coordinates.
template <class Vector>
double to_circle(const Vector& o, const Vector& d, double radius) {
  const double a = d.squaredNorm(), b = o.dot(d), c = o.squaredNorm() - radius * radius;
  const double discriminant = b * b - a * c;
  if (discriminant < 0.0) return kMissed;
  const double root = std::sqrt(discriminant);
  return std::min(positive((-b - root) / a), positive((-b + root) / a));
}

inline Distance ball(const Vector3d& center, double radius) {
  return [=](const Vector3d& origin, const Vector3d& direction) {
    return to_circle<Vector3d>(origin - center, direction, radius);
  };
}

/// From outside: the intersection of three slabs.
inline Distance box(const Pose& world_from_box, const Vector3d& size) {
  return [box_from_world = world_from_box.inverse(), size](const Vector3d& origin,
                                                           const Vector3d& direction) {
    const Vector3d o = box_from_world * origin, d = box_from_world.linear() * direction;
    double enter = 0.0, leave = kMissed;
    for (int axis = 0; axis < 3; ++axis) {
      const double a = (-0.5 * size[axis] - o[axis]) / d[axis];
      const double b = (0.5 * size[axis] - o[axis]) / d[axis];
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    return enter > 0.0 && enter <= leave ? enter : kMissed;
  };
}

/// From outside: side or cap; axis along z of its frame.
inline Distance cylinder(const Pose& world_from_cylinder, double radius, double length) {
  return [cylinder_from_world = world_from_cylinder.inverse(), radius, length](
             const Vector3d& origin, const Vector3d& direction) {
    const Vector3d o = cylinder_from_world * origin, d = cylinder_from_world.linear() * direction;
    double nearest = kMissed;
    const double side = to_circle<Eigen::Vector2d>(o.head<2>(), d.head<2>(), radius);
    if (std::isfinite(side) && std::abs(o.z() + side * d.z()) <= 0.5 * length) nearest = side;
    for (const double z : {-0.5 * length, 0.5 * length}) {
      const double cap = positive((z - o.z()) / d.z());
      if (std::isfinite(cap) && (o + cap * d).head<2>().norm() <= radius) {
        nearest = std::min(nearest, cap);
      }
    }
    return nearest;
  };
}

/// The nearest of several bodies.
inline double nearest(const std::vector<Distance>& bodies, const Vector3d& origin,
                      const Vector3d& direction) {
  double range = kMissed;
  for (const Distance& body : bodies) range = std::min(range, body(origin, direction));
  return range;
}

}  // namespace lidarena::gz_sim_test
