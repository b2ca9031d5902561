// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/inertial_smoother.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

#include "lidarena/base/so3.hpp"
#include "lidarena/estimation/inertial_state.hpp"

namespace lidarena::estimation {
namespace {

using State = NavState;

constexpr int kIterations = 3;       // quadratic convergence: two suffice, a third at the start
constexpr double kConverged = 1e-9;  // m, rad, ...: largest element of the step
constexpr double kKnownGravitySigma = 1e-6;  // rad: sigma of the direction of a known gravity
constexpr double kMinVariance = 1e-16;       // added to all, for random walks that are set to 0

Eigen::Index block(std::size_t state) { return 2 + static_cast<Eigen::Index>(state) * State::kDof; }

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
  start_gravity_ = start.gravity;
  prior_state_ = start.state;
  prior_tilt_.setZero();
  set_tilt(Eigen::Vector2d::Zero());
  const double sigma = std::max(start.gravity_sigma, kKnownGravitySigma);
  prior_information_.setZero();
  prior_information_.diagonal().head<2>().setConstant(1.0 / (sigma * sigma));
  prior_information_.bottomRightCorner<State::kDof, State::kDof>() = inverse(start.covariance);
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
  Prior error;
  const State::Vector difference = minus(states_.front(), prior_state_);
  error << tilt_ - prior_tilt_, difference;
  PriorInformation j = PriorInformation::Identity();
  j.bottomRightCorner<State::kDof, State::kDof>() = error_of_difference(difference);
  const PriorInformation weighted = j.transpose() * prior_information_;
  sum.hessian.topLeftCorner<error.RowsAtCompileTime, error.RowsAtCompileTime>() += weighted * j;
  sum.gradient.head<error.RowsAtCompileTime>() += weighted * error;
}

void InertialSmoother::add_motion(std::size_t first, Equations& sum) const {
  const InertialResidual r = motions_[first].residual(states_[first], states_[first + 1], gravity_);
  const Eigen::Matrix<double, 3, 2> basis = tangent_basis(start_gravity_);
  const Eigen::Matrix<double, 3, 2> gravity_by_tilt =
      -so3::hat(gravity_) * so3::left_jacobian(basis * tilt_) * basis;
  Eigen::Matrix<double, State::kDof, 2 + 2 * State::kDof> j;
  j << r.by_gravity * gravity_by_tilt, r.by_first, r.by_second;
  const State::Matrix information = inverse(motions_[first].covariance());
  const Eigen::Matrix<double, 2 + 2 * State::kDof, State::kDof> weighted =
      j.transpose() * information;
  const Eigen::Matrix<double, 2 + 2 * State::kDof, 2 + 2 * State::kDof> product = weighted * j;
  const Eigen::Matrix<double, 2 + 2 * State::kDof, 1> slope = weighted * r.value;
  const Eigen::Index at = block(first);
  constexpr Eigen::Index kStates = 2 * State::kDof;
  sum.hessian.topLeftCorner<2, 2>() += product.topLeftCorner<2, 2>();
  sum.hessian.block<2, kStates>(0, at) += product.topRightCorner<2, kStates>();
  sum.hessian.block<kStates, 2>(at, 0) += product.bottomLeftCorner<kStates, 2>();
  sum.hessian.block<kStates, kStates>(at, at) += product.bottomRightCorner<kStates, kStates>();
  sum.gradient.head<2>() += slope.head<2>();
  sum.gradient.segment<kStates>(at) += slope.tail<kStates>();
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
  set_tilt(tilt_ + step.head<2>());
  for (std::size_t i = 0; i < states_.size(); ++i) {
    states_[i] = plus(states_[i], step.segment<State::kDof>(block(i)));
    states_[i].world_from_imu = orthonormalized(states_[i].world_from_imu);
  }
}

void InertialSmoother::set_tilt(const Eigen::Vector2d& tilt) {
  tilt_ = tilt;
  gravity_ = so3::exp(tangent_basis(start_gravity_) * tilt) * start_gravity_;
}

void InertialSmoother::marginalize_oldest() {
  // The terms that involve the oldest state, as a normal distribution of only the tilt and the
  // second state.
  const Equations sum = equations(2, 1);
  const Eigen::Index oldest = block(0);
  const Eigen::Index second = block(1);
  Eigen::VectorXi keep(Prior::RowsAtCompileTime);
  for (int i = 0; i < keep.size(); ++i) keep[i] = i < 2 ? i : static_cast<int>(second) + i - 2;
  const State::Matrix oldest_hessian = sum.hessian.block<State::kDof, State::kDof>(oldest, oldest);
  const Eigen::MatrixXd coupling =
      sum.hessian(keep, Eigen::seqN(oldest, Eigen::Index{State::kDof}));
  const Eigen::LDLT<State::Matrix> factor(oldest_hessian);
  const PriorInformation schur =
      sum.hessian(keep, keep) - coupling * factor.solve(coupling.transpose());
  const Prior gradient =
      sum.gradient(keep) - coupling * factor.solve(sum.gradient.segment<State::kDof>(oldest));
  prior_information_ = 0.5 * (schur + schur.transpose());
  const Prior to_mean = -prior_information_.ldlt().solve(gradient);
  prior_tilt_ = tilt_ + to_mean.head<2>();
  prior_state_ = plus(states_[1], to_mean.tail<State::kDof>());
  states_.pop_front();
  motions_.pop_front();
  measurements_.pop_front();
}

}  // namespace lidarena::estimation
