// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/flight/flight.hpp"
#include "lidarena/flight/quadrotor.hpp"

namespace lidarena::flight {

/// The wrench that makes a quadrotor follow the motion `reference`: the geometric tracking
/// controller on SE(3) of Lee, Leok, McClamroch (CDC 2010) with its attitude error separated into
/// tilt and heading (Brescianini, D'Andrea, "Tilt-prioritized quadrocopter attitude control", TCST
/// 2020), so that a large heading error does not affect the tilt. Gains are given as natural
/// frequencies and a damping ratio. The desired attitude is the reference's attitude, rotated by
/// the shortest rotation that aligns its z axis with the desired force. The reference's rates and
/// its drag in still air are fed forward.
Wrench tracking_wrench(const Quadrotor& quadrotor, const QuadrotorState& state,
                       const Motion& reference);

}  // namespace lidarena::flight
