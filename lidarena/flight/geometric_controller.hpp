// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/flight/flight.hpp"
#include "lidarena/flight/quadrotor.hpp"

namespace lidarena {

/// The wrench that brings a quadrotor onto the motion `reference`: the geometric tracking
/// controller on SE(3) of Lee, Leok, McClamroch (CDC 2010) with its attitude error taken apart into
/// tilt and heading (Brescianini, D'Andrea, "Tilt-prioritized quadrocopter attitude control", TCST
/// 2020), so that a heading out of reach does not spoil the tilt. Gains are given as natural
/// frequencies and a damping ratio. The wanted attitude is the reference's, turned by the shortest
/// rotation that brings its z axis to the wanted force; the reference's rates are fed forward, as
/// is the drag it would meet in still air.
Wrench tracking_wrench(const Quadrotor& quadrotor, const QuadrotorState& state,
                       const Motion& reference);

}  // namespace lidarena
