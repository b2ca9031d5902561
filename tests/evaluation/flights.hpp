// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <functional>
#include <istream>
#include <string>
#include <vector>

#include "lidarena/base/random.hpp"
#include "lidarena/base/so3.hpp"
#include "lidarena/base/trajectory.hpp"

/// Small flights whose errors have a closed form.
namespace lidarena::evaluation::flights {

using Eigen::Vector3d;

/// `motion` (a function of seconds) sampled every `period` from 0 to `duration`, both inclusive.
inline Trajectory sample(const std::function<Pose(double)>& motion, Time period, Time duration) {
  std::vector<StampedPose> poses;
  for (Time t{0}; t <= duration; t += period) poses.push_back({t, motion(to_seconds(t))});
  return Trajectory(std::move(poses));
}

inline Pose level(const Vector3d& position) {
  return make_pose(Eigen::Quaterniond::Identity(), position);
}

/// A flight with curves, climbs and tilts, in which no direction is degenerate.
inline Pose tour(double t) {
  const Vector3d position(4.0 * std::sin(0.35 * t), 3.0 * std::sin(0.5 * t + 0.4),
                          1.5 + 0.8 * std::sin(0.3 * t + 1.0));
  return make_pose(so3::exp({0.10 * std::sin(0.9 * t), 0.08 * std::cos(0.7 * t), 0.4 * t}),
                   position);
}

inline Pose random_pose(SequentialRandom& random, double meters) {
  const Vector3d turn(random.normal(), random.normal(), random.normal());
  const Vector3d move(random.normal(), random.normal(), random.normal());
  return make_pose(so3::exp(turn), meters * move);
}

/// Each pose of `trajectory` replaced by change(pose).
inline Trajectory mapped(const Trajectory& trajectory,
                         const std::function<Pose(const StampedPose&)>& change) {
  std::vector<StampedPose> poses;
  for (const StampedPose& pose : trajectory.poses()) poses.push_back({pose.stamp, change(pose)});
  return Trajectory(std::move(poses));
}

/// Without the poses later than `from` and earlier than `to`.
inline Trajectory with_gap(const Trajectory& trajectory, Time from, Time to) {
  std::vector<StampedPose> poses;
  for (const StampedPose& pose : trajectory.poses()) {
    if (pose.stamp <= from || pose.stamp >= to) poses.push_back(pose);
  }
  return Trajectory(std::move(poses));
}

/// Every stamp later by `shift`.
inline Trajectory shifted(const Trajectory& trajectory, Time shift) {
  std::vector<StampedPose> poses(trajectory.poses().begin(), trajectory.poses().end());
  for (StampedPose& pose : poses) pose.stamp += shift;
  return Trajectory(std::move(poses));
}

}  // namespace lidarena::evaluation::flights
