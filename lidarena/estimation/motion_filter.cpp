// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/motion_filter.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <array>
#include <cmath>

#include "lidarena/base/so3.hpp"

namespace lidarena::estimation {
namespace {

// First index of each part of an error. Those of translation and rotation alternate.
constexpr int kPosition = 0, kRotation = 3, kVelocity = 6, kRate = 9, kAcceleration = 12,
              kAngularAcceleration = 15;

/// What an acceleration of 1 leaves after a time, as it decays: position, velocity, acceleration.
Eigen::Vector3d decayed(double seconds, double decay_time) {
  const double ratio = seconds / decay_time;
  const double gone = -std::expm1(-ratio);
  return {decay_time * decay_time * (ratio - gone), decay_time * gone, 1.0 - gone};
}

/// Covariance of position, velocity and acceleration that the changes of the acceleration cause
/// within a time, by Gauss' quadrature with three nodes.
Eigen::Matrix3d maneuver_covariance(double seconds, double deviation, double decay_time) {
  constexpr std::array kNodes{0.1127016653792583, 0.5, 0.8872983346207417};
  constexpr std::array kWeights{5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
  const double density = 2.0 * deviation * deviation / decay_time;  // of the white noise behind it
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < kNodes.size(); ++i) {
    const Eigen::Vector3d effect = decayed(kNodes[i] * seconds, decay_time);
    sum += kWeights[i] * seconds * density * effect * effect.transpose();
  }
  return sum;
}

/// Adds the covariance of a chain of a coordinate's derivatives, for each of three axes.
void add_chain(const Eigen::Matrix3d& covariance, const std::array<int, 3>& places,
               MotionMatrix& sum) {
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      sum.block<3, 3>(places[i], places[j]).diagonal().array() +=
          covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
    }
  }
}

}  // namespace

Pose MotionState::pose_after(double seconds) const {
  const double half_square = 0.5 * seconds * seconds;
  return make_pose(
      Eigen::Matrix3d(pose.linear() *
                      so3::exp(seconds * rate + half_square * angular_acceleration)),
      Eigen::Vector3d(pose.translation() + seconds * velocity + half_square * acceleration));
}

MotionState operator+(const MotionState& state, const MotionVector& error) {
  MotionState sum = state;
  sum.pose.translation() += error.segment<3>(kPosition);
  sum.pose.linear() = state.pose.linear() * so3::exp(error.segment<3>(kRotation));
  sum.velocity += error.segment<3>(kVelocity);
  sum.rate += error.segment<3>(kRate);
  sum.acceleration += error.segment<3>(kAcceleration);
  sum.angular_acceleration += error.segment<3>(kAngularAcceleration);
  return sum;
}

MotionVector operator-(const MotionState& to, const MotionState& from) {
  MotionVector error;
  error << to.pose.translation() - from.pose.translation(),
      so3::log(from.pose.linear().transpose() * to.pose.linear()), to.velocity - from.velocity,
      to.rate - from.rate, to.acceleration - from.acceleration,
      to.angular_acceleration - from.angular_acceleration;
  return error;
}

MotionPrediction predicted(const MotionEstimate& estimate, double seconds,
                           const ManeuverModel& model) {
  const MotionState& from = estimate.state;
  const Eigen::Vector3d linear = decayed(seconds, model.acceleration_time);
  const Eigen::Vector3d angular = decayed(seconds, model.angular_time);
  const Eigen::Vector3d turn = seconds * from.rate + angular[0] * from.angular_acceleration;
  MotionState to = from;
  to.pose =
      orthonormalized(make_pose(Eigen::Matrix3d(from.pose.linear() * so3::exp(turn)),
                                Eigen::Vector3d(from.pose.translation() + seconds * from.velocity +
                                                linear[0] * from.acceleration)));
  to.velocity += linear[1] * from.acceleration;
  to.acceleration *= linear[2];
  to.rate += angular[1] * from.angular_acceleration;
  to.angular_acceleration *= angular[2];

  MotionMatrix f = MotionMatrix::Identity();
  const Eigen::Matrix3d jacobian = so3::right_jacobian(turn);
  f.block<3, 3>(kPosition, kVelocity).diagonal().setConstant(seconds);
  f.block<3, 3>(kPosition, kAcceleration).diagonal().setConstant(linear[0]);
  f.block<3, 3>(kVelocity, kAcceleration).diagonal().setConstant(linear[1]);
  f.block<3, 3>(kAcceleration, kAcceleration).diagonal().setConstant(linear[2]);
  f.block<3, 3>(kRotation, kRotation) = so3::exp(-turn);
  f.block<3, 3>(kRotation, kRate) = seconds * jacobian;
  f.block<3, 3>(kRotation, kAngularAcceleration) = angular[0] * jacobian;
  f.block<3, 3>(kRate, kAngularAcceleration).diagonal().setConstant(angular[1]);
  f.block<3, 3>(kAngularAcceleration, kAngularAcceleration).diagonal().setConstant(angular[2]);
  MotionMatrix covariance = f * estimate.covariance * f.transpose();
  add_chain(maneuver_covariance(seconds, model.acceleration, model.acceleration_time),
            {kPosition, kVelocity, kAcceleration}, covariance);
  add_chain(maneuver_covariance(seconds, model.angular_acceleration, model.angular_time),
            {kRotation, kRate, kAngularAcceleration}, covariance);
  return {{to, covariance}, f};
}

// With prior covariance P, of which P6 are the rows and columns of the pose, H and g of the
// measurements, and d the error of `state` to the prior, the minimum is the prior plus
// P(:, 6) (I + H P6)^-1 (H d - g).
MotionEstimate updated(const MotionEstimate& prior, const MotionState& state,
                       const NormalEquations<6>& equations) {
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  const Eigen::Matrix<double, kMotionDof, 6> of_pose = prior.covariance.leftCols<6>();
  const Eigen::PartialPivLU<Matrix6> sum(Matrix6::Identity() +
                                         equations.hessian * of_pose.topRows<6>());
  const MotionVector error = state - prior.state;
  const Eigen::Matrix<double, 6, 1> pull = equations.hessian * error.head<6>() - equations.gradient;
  MotionEstimate minimum{prior.state + MotionVector(of_pose * sum.solve(pull)), prior.covariance};
  minimum.covariance.noalias() -= of_pose * sum.solve(equations.hessian) * of_pose.transpose();
  minimum.covariance = (0.5 * (minimum.covariance + minimum.covariance.transpose())).eval();
  return minimum;
}

std::vector<MotionEstimate> smoothed(std::span<const MotionStep> steps) {
  std::vector<MotionEstimate> estimates;
  estimates.reserve(steps.size());
  for (const MotionStep& step : steps) estimates.push_back(step.estimate);
  for (std::size_t i = steps.size(); i-- > 1;) {
    const MotionPrediction& prediction = steps[i].prediction;
    const MotionEstimate& expected = prediction.estimate;
    const MotionEstimate& after = estimates[i];
    MotionEstimate& estimate = estimates[i - 1];
    const MotionMatrix gain =
        expected.covariance.ldlt().solve(prediction.transition * estimate.covariance).transpose();
    estimate.state = estimate.state + MotionVector(gain * (after.state - expected.state));
    estimate.covariance += gain * (after.covariance - expected.covariance) * gain.transpose();
  }
  return estimates;
}

}  // namespace lidarena::estimation
