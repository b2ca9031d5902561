// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "lidarena/flight/flight_config.hpp"

namespace lidarena {

/// Yaw (rad, without jumps of 2 pi) of each direction; where one is nearly vertical the yaw before
/// it is held.
std::vector<double> yaw_along(std::span<const Eigen::Vector3d> directions);

/// A sine about a path's direction, faded in and out over one period at both ends of
/// [begin_s, end_s].
double sweep_at(double t, double begin_s, double end_s, double amplitude, double period_s);

/// Follows `yaw` by steps of at most `step`: what the body can turn between two control points.
void limit_steps(std::span<double> yaw, double step);

}  // namespace lidarena
