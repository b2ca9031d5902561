// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>

#include "lidarena/flight/flight.hpp"

namespace lidarena::flight {

/// The flat outputs of a quadrotor and their time derivatives: [n] holds the n-th derivative of
/// (x, y, z, yaw) in m and rad, world frame.
using FlatOutputs = std::array<Eigen::Vector4d, 5>;

/// Rotation world_from_body of a body whose thrust, along its z axis, gives `acceleration` (m/s^2,
/// world, without gravity): a rotation by `yaw` about z, followed by the shortest rotation from the
/// world's z axis to the direction of the thrust. The thrust must not point straight down.
/// Differential flatness: Mellinger, Kumar, "Minimum snap trajectory generation and control for
/// quadrotors" (ICRA 2011), with the yaw coordinate of Watterson, Kumar, "Control of quadrotors
/// using the Hopf fibration on SO(3)" (ISRR 2017), which is smooth except for thrust straight down.
Eigen::Matrix3d attitude_of(const Eigen::Vector3d& acceleration, double yaw);

/// The full motion; attitude, body rate and angular acceleration by exact differentiation.
Motion motion_of(const FlatOutputs& outputs);

}  // namespace lidarena::flight
