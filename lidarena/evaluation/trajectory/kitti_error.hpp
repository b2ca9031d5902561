// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "lidarena/base/trajectory.hpp"
#include "lidarena/evaluation/trajectory/trajectory_error.hpp"
#include "lidarena/results/trajectory_metrics.hpp"

namespace lidarena::evaluation {

/// The lengths of the KITTI odometry benchmark.
inline constexpr std::array kKittiLengths_m{100.0, 200.0, 300.0, 400.0, 500.0, 600.0, 700.0, 800.0};

using results::KittiError;

/// Frames are the estimate's poses with a truth pose at their stamp; path length is measured on the
/// truth. A piece starts at every tenth frame and ends at the first frame *beyond* the length, if
/// there is one; its errors are divided by the length. The mean is over all (start, length) pairs,
/// so long lengths count less. All poses must be of the same body frame (KITTI: the camera's).
KittiError kitti_error(const Trajectory& estimate, const Trajectory& truth,
                       std::span<const double> lengths_m = kKittiLengths_m);

}  // namespace lidarena::evaluation
