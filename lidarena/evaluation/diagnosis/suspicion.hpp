// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "lidarena/base/trajectory.hpp"

/// Detects input mistakes that make every error meaningless by comparing two trajectories. Each
/// function returns a warning text, or an empty string.
namespace lidarena::evaluation {

/// Times in milliseconds, microseconds or nanoseconds read as seconds (one trajectory lasts 1000,
/// 1e6 or 1e9 times as long as the other), or trajectories that do not overlap because their clocks
/// count from different instants.
std::string suspect_times(const Trajectory& estimate, const Trajectory& truth);

/// Positions in millimeters, centimeters, kilometers or feet: the path of one trajectory is that
/// many times as long as the other's, over the time that both cover.
std::string suspect_length_unit(const Trajectory& estimate, const Trajectory& truth);

/// Rotations that are all the same in one file while the other turns by more than 10 degrees: a
/// file of positions with made-up quaternions.
std::string suspect_constant_rotation(const Trajectory& estimate, const Trajectory& truth);

/// Quaternions written w x y z and read as x y z w: with the columns of one trajectory in the other
/// order, the rotations of both over a second differ by half as much or less. No warning if they
/// differ by less than 2 deg RMS as read, or after a constant mounting rotation is removed.
std::string suspect_quaternion_order(const Trajectory& estimate, const Trajectory& truth);

}  // namespace lidarena::evaluation
