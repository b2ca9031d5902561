// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "lidarena/base/pose.hpp"
#include "lidarena/base/random.hpp"
#include "lidarena/base/so3.hpp"

/// Simulated places made of points on walls, and paths through them, for tests of loop closure.
namespace lidarena::loop::places {

using Points = std::vector<Eigen::Vector3f>;

/// Adds the walls and, if `flat`, the floor and ceiling of a box, with a point every `step` m.
inline void add_box(Points& points, const Eigen::Vector3f& low, const Eigen::Vector3f& high,
                    bool flat, float step = 0.25F) {
  const Eigen::Vector3f size = high - low;
  const auto count = [&](int axis) { return static_cast<int>(size[axis] / step); };
  for (int axis = 0; axis < 3; ++axis) {
    if (axis == 2 && !flat) continue;
    const int u = (axis + 1) % 3;
    const int v = (axis + 2) % 3;
    for (int i = 0; i <= count(u); ++i) {
      for (int k = 0; k <= count(v); ++k) {
        Eigen::Vector3f p = low;
        p[u] += step * static_cast<float>(i);
        p[v] += step * static_cast<float>(k);
        points.push_back(p);
        p[axis] = high[axis];
        points.push_back(p);
      }
    }
  }
}

/// A corridor, 4 m wide, around a block of 16 x 16 m, with crates of all sizes along its walls.
inline Points ring_corridor() {
  Points points;
  add_box(points, {-12, -12, 0}, {12, 12, 3}, true);
  add_box(points, {-8, -8, 0}, {8, 8, 3}, false);
  std::erase_if(points, [](const Eigen::Vector3f& p) {
    return std::abs(p.x()) < 7.9F && std::abs(p.y()) < 7.9F;
  });
  SequentialRandom random(5, 1);
  for (int i = 0; i < 24; ++i) {
    const double along = random.uniform(-11.0, 11.0);
    const double off = random.uniform() < 0.5 ? 8.6 : 11.4;
    const double side = random.uniform() < 0.5 ? 1.0 : -1.0;
    const bool upright = random.uniform() < 0.5;
    const Eigen::Vector3f at(static_cast<float>(upright ? side * off : along),
                             static_cast<float>(upright ? along : side * off), 0.0F);
    const Eigen::Vector3f half(static_cast<float>(random.uniform(0.2, 0.5)),
                               static_cast<float>(random.uniform(0.2, 0.5)), 0.0F);
    const Eigen::Vector3f top(0.0F, 0.0F, static_cast<float>(random.uniform(0.4, 2.5)));
    add_box(points, at - half, at + half + top, true, 0.12F);
  }
  return points;
}

/// Adds a room of 8 x 6 x 3 m around (x, 0) with three boxes in it.
inline void add_room(Points& points, float x) {
  add_box(points, {x - 4, -3, 0}, {x + 4, 3, 3}, true);
  add_box(points, {x - 3, 1.5F, 0}, {x - 2, 2.5F, 1}, true, 0.12F);
  add_box(points, {x + 2.5F, -2.5F, 0}, {x + 3.5F, -2, 2}, true, 0.12F);
  add_box(points, {x + 1.5F, 2, 0}, {x + 2, 2.5F, 3}, true, 0.12F);
}

/// The points within `reach` (m) of the pose, in its frame, with 1 cm of noise per axis.
inline Points seen_from(const Pose& pose, const Points& world, double reach, std::uint64_t seed) {
  SequentialRandom random(seed, 7);
  const Pose back = pose.inverse();
  Points seen;
  for (const Eigen::Vector3f& p : world) {
    const Eigen::Vector3d q = back * p.cast<double>();
    if (q.norm() > reach) continue;
    const double x = random.normal();
    const double y = random.normal();
    seen.push_back((q + 0.01 * Eigen::Vector3d(x, y, random.normal())).cast<float>());
  }
  return seen;
}

/// Pose at (x, y), at a height of 1.5 m, with heading `yaw`.
inline Pose standing(double x, double y, double yaw) {
  return make_pose(so3::exp({0.0, 0.0, yaw}), {x, y, 1.5});
}

/// Pose after `meters` along a square of 20 x 20 m in the middle of the corridor, heading along the
/// path.
inline Pose around_the_block(double meters) {
  const double along = std::fmod(meters, 80.0);
  const int side = static_cast<int>(along / 20.0);
  const double yaw = side * std::acos(-1.0) / 2.0;
  const Pose corner = make_pose(so3::exp({0.0, 0.0, yaw}), Eigen::Vector3d::Zero());
  return corner * standing(along - 20.0 * side - 10.0, -10.0, 0.0);
}

}  // namespace lidarena::loop::places
