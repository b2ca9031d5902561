// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/estimation/inertial_state.hpp"
#include "lidarena/estimation/iterated_update.hpp"
#include "lidarena/estimation/plane_fit.hpp"

namespace lidarena::estimation {

/// Residual of one point: its distance from the plane and the row of the Jacobian (FAST-LIO2,
/// eq. 12-14).
struct PointResidual {
  double distance = 0.0;  ///< m, signed
  Eigen::Matrix<double, 1, kPointDof> row;
};
/// `point`: m, LiDAR frame; `plane`: world frame. Without `extrinsics` the residual does not depend
/// on the LiDAR's pose on the IMU.
PointResidual point_residual(const Eigen::Vector3d& point, const Plane& plane,
                             const InertialState& state, bool extrinsics);

/// Whether a residual (m) is small enough for the point's range (m) to be an inlier: below 0.11 m
/// at 1 m, 0.35 m at 10 m, as in FAST-LIO2's program.
bool is_inlier(double distance, double range);

/// The plane that each point is registered with.
using PointPlanes = std::vector<std::optional<Plane>>;

/// Sums of the residuals of `points` (m, LiDAR frame), each with its plane; those without a plane
/// are left out. A point that is no inlier of its plane loses it.
NormalEquations<kPointDof> sum_residuals(std::span<const Eigen::Vector3f> points,
                                         const InertialState& state, bool extrinsics,
                                         PointPlanes& planes, const Parallel& parallel);

}  // namespace lidarena::estimation
