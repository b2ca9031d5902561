// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "lidarena/base/trajectory.hpp"

namespace lidarena {

/// The same piece of a flight as both trajectories have it, each in the frame of its own start; so
/// neither world frame matters.
struct MotionPair {
  Pose truth = Pose::Identity();
  Pose estimate = Pose::Identity();
};

/// Motions over about one second between poses of the estimate, truth interpolated; at most about
/// a thousand, spread over the flight; none with an end in a gap.
std::vector<MotionPair> motion_pairs(const Trajectory& estimate, const Trajectory& truth);

/// The constant rotation body_from_estimate that takes the estimate's turns best into the truth's
/// (Park, Martin, "Robot sensor calibration: solving AX = XB on the Euclidean group", 1994); the
/// identity where all turns have one axis, for then it is not determined.
Eigen::Matrix3d mounting_of(std::span<const MotionPair> motions);

}  // namespace lidarena
