// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "lidarena/base/trajectory.hpp"

namespace lidarena::evaluation {

/// The motion over the same time interval in both trajectories, each in the frame of its own start,
/// hence independent of both world frames.
struct MotionPair {
  Pose truth = Pose::Identity();
  Pose estimate = Pose::Identity();
};

/// Motions over about one second between poses of the estimate, with the truth interpolated; at
/// most about a thousand, spread over the flight; none with an end in a gap.
std::vector<MotionPair> motion_pairs(const Trajectory& estimate, const Trajectory& truth);

/// The constant rotation body_from_estimate that best maps the estimate's rotations to the truth's
/// (Park, Martin, "Robot sensor calibration: solving AX = XB on the Euclidean group", 1994); the
/// identity when all rotations have the same axis, because it is not determined then.
Eigen::Matrix3d mounting_of(std::span<const MotionPair> motions);

}  // namespace lidarena::evaluation
