// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "lidarena/base/trajectory.hpp"

/// Mistakes that make every error meaningless, found by comparing two trajectories. Each function
/// gives a warning in words, or nothing.
namespace lidarena {

/// Times in milliseconds, microseconds or nanoseconds taken for seconds (one trajectory lasts 1000,
/// 1e6 or 1e9 times as long as the other), or trajectories that do not meet because their clocks
/// count from different instants.
std::string suspect_times(const Trajectory& estimate, const Trajectory& truth);

/// Quaternions written w x y z and read as x y z w: with the columns of one trajectory put in the
/// other order, their turns over a second differ half as much or less. Turns that differ under 2
/// deg RMS as they are, or seen through a constant mounting, are left alone.
std::string suspect_quaternion_order(const Trajectory& estimate, const Trajectory& truth);

}  // namespace lidarena
