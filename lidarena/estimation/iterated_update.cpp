// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/iterated_update.hpp"

#include <Eigen/Cholesky>

#include "lidarena/base/so3.hpp"

namespace lidarena::estimation {
namespace {

using State = InertialState;

State::Matrix inverse(const State::Matrix& covariance) {
  return covariance.ldlt().solve(State::Matrix::Identity());
}

State::Matrix symmetric(const State::Matrix& m) { return 0.5 * (m + m.transpose()); }

}  // namespace

IteratedUpdate iterated_update(const StateEstimate& prior, const PointResiduals& residuals,
                               const IteratedUpdateOptions& options) {
  IteratedUpdate result;
  result.estimate = prior;
  State x = prior.state;
  int converged_before = 0;
  bool search = true;
  for (int i = 0; i <= options.max_iterations; ++i) {
    const NormalEquations<kPointDof> points = residuals(x, search);
    ++result.evaluations;
    if (points.count == 0) continue;
    result.points = points;

    // Mean and covariance of the prior in the tangent space at x.
    const State::Vector moved = minus(x, prior.state);
    const State::Matrix a = transport(prior.state, moved);
    const State::Matrix prior_information =
        inverse(symmetric(a * prior.covariance * a.transpose()));

    State::Matrix information = prior_information;
    State::Vector gradient = prior_information * (a * moved);
    information.topLeftCorner<kPointDof, kPointDof>() += points.hessian / options.variance;
    gradient.head<kPointDof>() += points.gradient / options.variance;
    const State::Vector step = -information.ldlt().solve(gradient);

    const State::Matrix to_new = transport(x, step);
    x = plus(x, step);
    result.estimate = {x, symmetric(to_new * inverse(information) * to_new.transpose())};

    const bool converged = step.cwiseAbs().maxCoeff() <= options.tolerance;
    converged_before += converged ? 1 : 0;
    result.converged = converged_before > 0;
    if (converged_before == 2) break;
    search = converged || (converged_before == 0 && i + 1 == options.max_iterations);
  }
  return result;
}

namespace {

/// Kalman update with a measurement of N neighboring components of the state: `off` is measured
/// minus predicted, in their tangent space.
template <int N>
StateEstimate observe(const StateEstimate& prior, State::Block first,
                      const Eigen::Vector<double, N>& off, const Eigen::Vector<double, N>& sigma) {
  const auto columns = prior.covariance.middleCols<N>(first);
  Eigen::Matrix<double, N, N> innovation = columns.template middleRows<N>(first);
  innovation += sigma.cwiseAbs2().asDiagonal();
  const Eigen::Matrix<double, State::kDof, N> gain =
      innovation.ldlt().solve(columns.transpose()).transpose();
  const State::Vector step = gain * off;
  const State::Matrix covariance = prior.covariance - gain * columns.transpose();
  const State::Matrix to_new = transport(prior.state, step);
  return {plus(prior.state, step), symmetric(to_new * covariance * to_new.transpose())};
}

}  // namespace

StateEstimate zero_velocity_update(const StateEstimate& prior, double sigma) {
  return observe<3>(prior, State::kVelocity, -prior.state.nav.velocity,
                    Eigen::Vector3d::Constant(sigma));
}

StateEstimate pose_update(const StateEstimate& prior, const Pose& world_from_imu,
                          double position_sigma, double rotation_sigma) {
  static_assert(State::kRotation == State::kPosition + 3);
  State measured = prior.state;
  measured.position() = world_from_imu.translation();
  measured.rotation() = world_from_imu.linear();
  Eigen::Vector<double, 6> sigma;
  sigma << Eigen::Vector3d::Constant(position_sigma), Eigen::Vector3d::Constant(rotation_sigma);
  return observe<6>(prior, State::kPosition,
                    minus(measured, prior.state).segment<6>(State::kPosition), sigma);
}

Eigen::Matrix<double, 6, 6> body_covariance(const StateEstimate& estimate,
                                            const Eigen::Matrix3d& frame_from_world,
                                            const Pose& imu_from_body) {
  Eigen::Matrix<double, 6, 6> by_state = Eigen::Matrix<double, 6, 6>::Zero();
  by_state.topLeftCorner<3, 3>() = frame_from_world;
  by_state.topRightCorner<3, 3>() =
      -frame_from_world * estimate.state.rotation() * so3::hat(imu_from_body.translation());
  by_state.bottomRightCorner<3, 3>() = imu_from_body.linear().transpose();
  return by_state * estimate.covariance.topLeftCorner<6, 6>() * by_state.transpose();
}

}  // namespace lidarena::estimation
