// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace lidarena {

/// Body rate (rad/s) of R(t) = R0 exp(v(t)) where the rotation vector is `v` and moves at `dv`:
/// right_jacobian(v) * dv. |v| < 2 pi.
Eigen::Vector3d body_rate(const Eigen::Vector3d& v, const Eigen::Vector3d& dv);

/// Time derivative of body_rate() when v's second derivative is `ddv`.
Eigen::Vector3d body_acceleration(const Eigen::Vector3d& v, const Eigen::Vector3d& dv,
                                  const Eigen::Vector3d& ddv);

}  // namespace lidarena
