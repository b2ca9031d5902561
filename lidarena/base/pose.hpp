// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <span>
#include <vector>

namespace lidarena {

/// A rigid transform. Variables are named `a_from_b`: `world_from_body * p_body` is in world.
using Pose = Eigen::Isometry3d;

inline Pose make_pose(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& translation) {
  Pose pose = Pose::Identity();
  pose.linear() = rotation.normalized().toRotationMatrix();
  pose.translation() = translation;
  return pose;
}

inline Pose make_pose(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation) {
  Pose pose = Pose::Identity();
  pose.linear() = rotation;
  pose.translation() = translation;
  return pose;
}

/// Linear in position, spherical-linear in rotation; `s` in [0, 1] from `a` to `b`.
inline Pose interpolate(const Pose& a, const Pose& b, double s) {
  const Eigen::Quaterniond qa(a.linear());
  const Eigen::Quaterniond qb(b.linear());
  return make_pose(qa.slerp(s, qb), a.translation() + s * (b.translation() - a.translation()));
}

/// The same pose with its rotation made orthonormal again (after many products).
inline Pose orthonormalized(const Pose& pose) {
  return make_pose(Eigen::Quaterniond(pose.linear()), pose.translation());
}

/// Appends `pose` times each of `points` (m) to `out`; computed in double precision.
inline void append_transformed(const Pose& pose, std::span<const Eigen::Vector3f> points,
                               std::vector<Eigen::Vector3f>& out) {
  out.reserve(out.size() + points.size());
  for (const Eigen::Vector3f& p : points) out.push_back((pose * p.cast<double>()).cast<float>());
}
inline std::vector<Eigen::Vector3f> transformed(const Pose& pose,
                                                std::span<const Eigen::Vector3f> points) {
  std::vector<Eigen::Vector3f> moved;
  append_transformed(pose, points, moved);
  return moved;
}

}  // namespace lidarena
