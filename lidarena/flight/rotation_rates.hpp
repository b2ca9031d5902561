// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace lidarena::flight {

/// Body rate (rad/s) of R(t) = R0 exp(v(t)) for the rotation vector `v` with time derivative `dv`:
/// right_jacobian(v) * dv. |v| < 2 pi.
Eigen::Vector3d body_rate(const Eigen::Vector3d& v, const Eigen::Vector3d& dv);

/// Time derivative of body_rate() for the second derivative `ddv` of v.
Eigen::Vector3d body_acceleration(const Eigen::Vector3d& v, const Eigen::Vector3d& dv,
                                  const Eigen::Vector3d& ddv);

}  // namespace lidarena::flight
