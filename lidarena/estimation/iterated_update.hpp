// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>

#include "lidarena/estimation/inertial_state.hpp"
#include "lidarena/estimation/least_squares.hpp"

namespace lidarena::estimation {

/// Estimate of the motion: the state and the covariance of its error.
struct StateEstimate {
  InertialState state;
  InertialState::Matrix covariance = InertialState::Matrix::Identity();
};

/// Number of error components that LiDAR points depend on: position, rotation, and the rotation and
/// position of the LiDAR.
inline constexpr int kPointDof = 12;

struct IteratedUpdateOptions {
  int max_iterations = 3;   ///< at most one more evaluation than this
  double tolerance = 1e-3;  ///< converged if no component of the step is larger
  double variance = 1e-3;   ///< m^2, of each point's residual
};

struct IteratedUpdate {
  StateEstimate estimate;
  int evaluations = 0;
  bool converged = false;
  /// Of the last evaluation that had residuals; its count is 0 if none had: then `estimate` is the
  /// prior.
  NormalEquations<kPointDof> points;
};

/// Residuals r (m) of all points at a state, as the sums of J^T J and J^T r. If `search`, searches
/// for new correspondences, else uses the previous ones.
using PointResiduals =
    std::function<NormalEquations<kPointDof>(const InertialState& state, bool search)>;

/// Update of an iterated error-state Kalman filter on the manifold, with the form of the gain that
/// inverts a matrix of the size of the state instead of that of the measurements (FAST-LIO2, eq.
/// 14-18, after He, Xu, Zhang, "Kalman Filters on Differentiable Manifolds", 2021). New
/// correspondences are searched at the start, whenever an evaluation has converged, and for the
/// last evaluation if none has.
IteratedUpdate iterated_update(const StateEstimate& prior, const PointResiduals& residuals,
                               const IteratedUpdateOptions& options);

/// Kalman update with the measurement "the velocity is zero", sigma `sigma` m/s on each axis.
StateEstimate zero_velocity_update(const StateEstimate& prior, double sigma);
/// Kalman update with a measured pose of the IMU, with sigmas in m and rad on each axis.
StateEstimate pose_update(const StateEstimate& prior, const Pose& world_from_imu,
                          double position_sigma, double rotation_sigma);

/// Covariance of the (translation, rotation) of a body that is fixed to the IMU: m along the axes
/// of a frame, which are those of the state's world rotated by `frame_from_world`; rad about the
/// body's axes.
Eigen::Matrix<double, 6, 6> body_covariance(const StateEstimate& estimate,
                                            const Eigen::Matrix3d& frame_from_world,
                                            const Pose& imu_from_body);

}  // namespace lidarena::estimation
