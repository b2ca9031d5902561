// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/inertial_smoother.hpp"

#include <Eigen/Cholesky>

#include "lidarena/base/so3.hpp"

namespace lidarena::estimation {
namespace {

constexpr int kIterations = 3;          // quadratic convergence: two suffice, a third at the start
constexpr double kConverged = 1e-9;     // m, rad, ...: largest element of the step
constexpr double kMinVariance = 1e-16;  // added to all, for random walks that are set to 0

Eigen::Index block(std::size_t state) { return static_cast<Eigen::Index>(state) * NavState::kDof; }

NavState::Matrix padded_inverse(const NavState::Matrix& covariance) {
  NavState::Matrix padded = covariance;
  padded.diagonal().array() += kMinVariance;
  return padded.ldlt().solve(NavState::Matrix::Identity());
}

/// Jacobian of minus(state, mean) with respect to an error of the state.
NavState::Matrix error_of_difference(const NavState::Vector& difference) {
  NavState::Matrix j = NavState::Matrix::Identity();
  j.topLeftCorner<3, 3>() = so3::right_jacobian_inverse(difference.head<3>());
  return j;
}

}  // namespace

void InertialSmoother::start(const InertialStart& start) {
  states_ = {start.state};
  motions_.clear();
  measurements_ = {{start.state.world_from_imu, PoseMeasurement::Information::Zero()}};
  gravity_ = start.gravity;
  prior_state_ = start.state;
  prior_information_ = padded_inverse(start.covariance);
  covariance_ = start.covariance;
}

void InertialSmoother::add(const Preintegration& since_last, const PoseMeasurement& measured) {
  states_.push_back(since_last.predict(states_.back(), gravity_));
  motions_.push_back(since_last);
  measurements_.push_back(measured);
  for (int i = 0; i < kIterations; ++i) {
    const Equations sum = equations(states_.size(), measurements_.size());
    const Eigen::LDLT<Eigen::MatrixXd> factor(sum.hessian);
    const Eigen::VectorXd step = -factor.solve(sum.gradient);
    move(step);
    const bool last = i + 1 == kIterations || step.cwiseAbs().maxCoeff() < kConverged;
    if (!last) continue;
    const auto size = sum.hessian.rows();
    Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(size, NavState::kDof);
    unit.bottomRows<NavState::kDof>().setIdentity();
    covariance_ = factor.solve(unit).bottomRows<NavState::kDof>();
    break;
  }
  if (states_.size() > lag_ + 1) marginalize_oldest();
}

InertialSmoother::Equations InertialSmoother::equations(std::size_t states,
                                                        std::size_t measurements) const {
  Equations sum{Eigen::MatrixXd::Zero(block(states), block(states)),
                Eigen::VectorXd::Zero(block(states))};
  add_prior(sum);
  for (std::size_t i = 0; i + 1 < states; ++i) add_motion(i, sum);
  for (std::size_t i = 0; i < measurements; ++i) add_measurement(i, sum);
  return sum;
}

void InertialSmoother::add_prior(Equations& sum) const {
  const NavState::Vector error = minus(states_.front(), prior_state_);
  const NavState::Matrix j = error_of_difference(error);
  const NavState::Matrix weighted = j.transpose() * prior_information_;
  sum.hessian.topLeftCorner<NavState::kDof, NavState::kDof>() += weighted * j;
  sum.gradient.head<NavState::kDof>() += weighted * error;
}

void InertialSmoother::add_motion(std::size_t first, Equations& sum) const {
  const InertialResidual r = motions_[first].residual(states_[first], states_[first + 1], gravity_);
  constexpr int kTwoStates = 2 * NavState::kDof;
  Eigen::Matrix<double, NavState::kDof, kTwoStates> j;
  j << r.by_first, r.by_second;
  const Eigen::Matrix<double, kTwoStates, NavState::kDof> weighted =
      j.transpose() * padded_inverse(motions_[first].covariance());
  const Eigen::Index at = block(first);
  sum.hessian.block<kTwoStates, kTwoStates>(at, at) += weighted * j;
  sum.gradient.segment<kTwoStates>(at) += weighted * r.value;
}

void InertialSmoother::add_measurement(std::size_t state, Equations& sum) const {
  const PoseMeasurement& measured = measurements_[state];
  const Pose& estimated = states_[state].world_from_imu;
  Eigen::Matrix<double, 6, 1> error;
  error << so3::log(measured.world_from_imu.linear().transpose() * estimated.linear()),
      estimated.translation() - measured.world_from_imu.translation();
  Eigen::Matrix<double, 6, NavState::kDof> j = Eigen::Matrix<double, 6, NavState::kDof>::Zero();
  j.block<3, 3>(0, NavState::kRotation) = so3::right_jacobian_inverse(error.head<3>());
  j.block<3, 3>(3, NavState::kPosition).setIdentity();
  const Eigen::Matrix<double, NavState::kDof, 6> weighted = j.transpose() * measured.information;
  const Eigen::Index at = block(state);
  sum.hessian.block<NavState::kDof, NavState::kDof>(at, at) += weighted * j;
  sum.gradient.segment<NavState::kDof>(at) += weighted * error;
}

void InertialSmoother::move(const Eigen::VectorXd& step) {
  for (std::size_t i = 0; i < states_.size(); ++i) {
    states_[i] = plus(states_[i], step.segment<NavState::kDof>(block(i)));
    states_[i].world_from_imu = orthonormalized(states_[i].world_from_imu);
  }
}

void InertialSmoother::marginalize_oldest() {
  // The terms that involve the oldest state, as a normal distribution of only the second state.
  const Equations sum = equations(2, 1);
  const NavState::Matrix coupling = sum.hessian.bottomLeftCorner<NavState::kDof, NavState::kDof>();
  const Eigen::LDLT<NavState::Matrix> oldest(
      sum.hessian.topLeftCorner<NavState::kDof, NavState::kDof>());
  const NavState::Matrix schur = sum.hessian.bottomRightCorner<NavState::kDof, NavState::kDof>() -
                                 coupling * oldest.solve(coupling.transpose());
  const NavState::Vector gradient = sum.gradient.tail<NavState::kDof>() -
                                    coupling * oldest.solve(sum.gradient.head<NavState::kDof>());
  prior_information_ = 0.5 * (schur + schur.transpose());
  prior_state_ = plus(states_[1], -prior_information_.ldlt().solve(gradient));
  states_.pop_front();
  motions_.pop_front();
  measurements_.pop_front();
}

}  // namespace lidarena::estimation
