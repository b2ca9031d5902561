// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/inertial_smoother.hpp"

#include <Eigen/Cholesky>

#include "lidarena/base/so3.hpp"

namespace lidarena::estimation {
namespace {

using State = NavState;

constexpr int kIterations = 3;          // quadratic convergence: two suffice, a third at the start
constexpr double kConverged = 1e-9;     // m, rad, ...: largest element of the step
constexpr double kMinVariance = 1e-16;  // added to all, for random walks that are set to 0

Eigen::Index block(std::size_t state) { return static_cast<Eigen::Index>(state) * State::kDof; }

State::Matrix inverse(const State::Matrix& covariance) {
  State::Matrix padded = covariance;
  padded.diagonal().array() += kMinVariance;
  return padded.ldlt().solve(State::Matrix::Identity());
}

/// Jacobian of minus(state, mean) with respect to an error of the state.
State::Matrix error_of_difference(const State::Vector& difference) {
  State::Matrix j = State::Matrix::Identity();
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
  prior_information_ = inverse(start.covariance);
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
    Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(size, State::kDof);
    unit.bottomRows<State::kDof>().setIdentity();
    covariance_ = factor.solve(unit).bottomRows<State::kDof>();
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
  const State::Vector error = minus(states_.front(), prior_state_);
  const State::Matrix j = error_of_difference(error);
  const State::Matrix weighted = j.transpose() * prior_information_;
  sum.hessian.topLeftCorner<State::kDof, State::kDof>() += weighted * j;
  sum.gradient.head<State::kDof>() += weighted * error;
}

void InertialSmoother::add_motion(std::size_t first, Equations& sum) const {
  const InertialResidual r = motions_[first].residual(states_[first], states_[first + 1], gravity_);
  constexpr int kTwoStates = 2 * State::kDof;
  Eigen::Matrix<double, State::kDof, kTwoStates> j;
  j << r.by_first, r.by_second;
  const Eigen::Matrix<double, kTwoStates, State::kDof> weighted =
      j.transpose() * inverse(motions_[first].covariance());
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
  Eigen::Matrix<double, 6, State::kDof> j = Eigen::Matrix<double, 6, State::kDof>::Zero();
  j.block<3, 3>(0, State::kRotation) = so3::right_jacobian_inverse(error.head<3>());
  j.block<3, 3>(3, State::kPosition).setIdentity();
  const Eigen::Matrix<double, State::kDof, 6> weighted = j.transpose() * measured.information;
  const Eigen::Index at = block(state);
  sum.hessian.block<State::kDof, State::kDof>(at, at) += weighted * j;
  sum.gradient.segment<State::kDof>(at) += weighted * error;
}

void InertialSmoother::move(const Eigen::VectorXd& step) {
  for (std::size_t i = 0; i < states_.size(); ++i) {
    states_[i] = plus(states_[i], step.segment<State::kDof>(block(i)));
    states_[i].world_from_imu = orthonormalized(states_[i].world_from_imu);
  }
}

void InertialSmoother::marginalize_oldest() {
  // The terms that involve the oldest state, as a normal distribution of only the second state.
  const Equations sum = equations(2, 1);
  const State::Matrix coupling = sum.hessian.bottomLeftCorner<State::kDof, State::kDof>();
  const Eigen::LDLT<State::Matrix> oldest(sum.hessian.topLeftCorner<State::kDof, State::kDof>());
  const State::Matrix schur = sum.hessian.bottomRightCorner<State::kDof, State::kDof>() -
                              coupling * oldest.solve(coupling.transpose());
  const State::Vector gradient =
      sum.gradient.tail<State::kDof>() - coupling * oldest.solve(sum.gradient.head<State::kDof>());
  prior_information_ = 0.5 * (schur + schur.transpose());
  prior_state_ = plus(states_[1], -prior_information_.ldlt().solve(gradient));
  states_.pop_front();
  motions_.pop_front();
  measurements_.pop_front();
}

}  // namespace lidarena::estimation
