// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "lidarena/flight/flight_config.hpp"

namespace lidarena::flight {

/// Yaw (rad, without jumps of 2 pi) of each direction; for nearly vertical directions the previous
/// yaw is kept.
std::vector<double> yaw_along(std::span<const Eigen::Vector3d> directions);

/// Offset (rad) of the yaw in mode sweep: a sine, faded in and out over one period at both ends of
/// [begin_s, end_s].
double sweep_at(double t, double begin_s, double end_s, double amplitude, double period_s);

/// Limits the change of `yaw` (rad) between consecutive control points to `step`.
void limit_steps(std::span<double> yaw, double step);

}  // namespace lidarena::flight
