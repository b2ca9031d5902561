// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/motion_filter.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>

#include "lidarena/base/random.hpp"
#include "lidarena/base/so3.hpp"

namespace lidarena::estimation {
namespace {

constexpr ManeuverModel kModel{3.0, 0.3, 15.0, 0.1};

MotionEstimate some_estimate() {
  MotionEstimate estimate;
  estimate.state.pose = make_pose(so3::exp({0.4, -0.3, 1.0}), {1.0, 2.0, -0.5});
  estimate.state.velocity = {2.0, -1.0, 0.5};
  estimate.state.rate = {1.0, -2.0, 4.0};
  estimate.state.acceleration = {3.0, 1.0, -2.0};
  estimate.state.angular_acceleration = {20.0, -10.0, 5.0};
  SequentialRandom random(3, 1);
  MotionMatrix root;
  for (int i = 0; i < root.size(); ++i) root(i) = 0.01 * random.normal();
  estimate.covariance = root * root.transpose() + 1e-4 * MotionMatrix::Identity();
  return estimate;
}

TEST(MotionFilter, TheDifferenceOfStatesIsWhatWasAdded) {
  const MotionState state = some_estimate().state;
  const MotionVector error = MotionVector::LinSpaced(-0.2, 0.3);
  EXPECT_LT(((state + error) - state - error).norm(), 1e-12);
}

TEST(MotionFilter, TheTransitionIsTheNumericDerivativeOfThePrediction) {
  const MotionEstimate before = some_estimate();
  for (const double seconds : {0.005, 0.1}) {
    const MotionPrediction prediction = predicted(before, seconds, kModel);
    for (int i = 0; i < kMotionDof; ++i) {
      constexpr double kStep = 1e-5;
      const MotionVector step = kStep * MotionVector::Unit(i);
      const MotionState plus = predicted({before.state + step, {}}, seconds, kModel).estimate.state;
      const MotionState minus =
          predicted({before.state + (-step), {}}, seconds, kModel).estimate.state;
      const MotionVector numeric =
          ((plus - prediction.estimate.state) - (minus - prediction.estimate.state)) /
          (2.0 * kStep);
      EXPECT_LT((numeric - prediction.transition.col(i)).norm(), 1e-8) << i;
    }
  }
}

/// Carries the estimate over `seconds` in `steps`.
MotionEstimate carried(MotionEstimate estimate, double seconds, int steps) {
  for (int i = 0; i < steps; ++i) estimate = predicted(estimate, seconds / steps, kModel).estimate;
  return estimate;
}

TEST(MotionFilter, OneLongStepIsManyShortOnes) {
  MotionEstimate before = some_estimate();
  before.state.rate = {0.0, 0.0, 2.0};  // about a fixed axis, in which steps are exact
  before.state.angular_acceleration = {0.0, 0.0, -5.0};
  const MotionEstimate one = carried(before, 0.08, 1);
  const MotionEstimate many = carried(before, 0.08, 200);
  EXPECT_LT((one.state - many.state).norm(), 1e-9);
  EXPECT_LT((one.covariance - many.covariance).norm(), 0.01 * many.covariance.norm());
}

TEST(MotionFilter, WithoutManeuversAccelerationsForgetTheirValueAndKeepTheirSpread) {
  MotionEstimate estimate = some_estimate();
  for (int i = 0; i < 2000; ++i) estimate = predicted(estimate, 0.005, kModel).estimate;
  EXPECT_LT(estimate.state.acceleration.norm(), 1e-6);
  EXPECT_NEAR(std::sqrt(estimate.covariance(12, 12)), kModel.acceleration, 0.01);
  EXPECT_NEAR(std::sqrt(estimate.covariance(15, 15)), kModel.angular_acceleration, 0.05);
}

TEST(MotionFilter, TheUpdateIsTheMinimumOfTheWholeCost) {
  const MotionEstimate prior = some_estimate();
  NormalEquations<6> equations;
  SequentialRandom random(4, 1);
  for (int i = 0; i < 20; ++i) {
    Eigen::Matrix<double, 1, 6> row;
    for (int k = 0; k < 6; ++k) row[k] = random.normal();
    equations.add<1>(row, Eigen::Matrix<double, 1, 1>(0.01 * random.normal()), 1e3);
  }
  MotionVector away = MotionVector::Zero();
  away.head<3>() = Eigen::Vector3d(0.01, -0.02, 0.005);
  const MotionEstimate posterior = updated(prior, prior.state + away, equations);
  // The same with the information of all 18 unknowns; the rotation of `away` is zero, so that the
  // prior's cost is quadratic.
  MotionMatrix information = prior.covariance.inverse();
  information.topLeftCorner<6, 6>() += equations.hessian;
  MotionVector pull = MotionVector::Zero();
  pull.head<6>() = equations.hessian * away.head<6>() - equations.gradient;
  const MotionVector expected = information.ldlt().solve(pull);
  EXPECT_LT((posterior.state - prior.state - expected).norm(), 1e-9);
  EXPECT_LT((posterior.covariance - information.inverse()).norm(), 1e-9);
}

TEST(MotionFilter, SmoothingGivesTheEarlierStateWhatTheLaterOneMeasured) {
  MotionEstimate before = some_estimate();
  before.state.rate.setZero();  // then all is linear
  before.state.angular_acceleration.setZero();
  const MotionPrediction prediction = predicted(before, 0.01, kModel);
  const MotionEstimate& prior = prediction.estimate;
  NormalEquations<6> equations;
  equations.hessian.diagonal().head<3>().setConstant(1e6);
  equations.gradient.head<3>() = -1e6 * Eigen::Vector3d(0.02, -0.01, 0.03);
  const MotionEstimate posterior = updated(prior, prior.state, equations);
  const std::array steps{MotionStep{{before, {}}, before}, MotionStep{prediction, posterior}};
  const std::vector<MotionEstimate> both = smoothed(steps);
  // The joint covariance of both states, conditioned on the measured positions.
  const Eigen::Matrix<double, kMotionDof, 3> cross =
      (before.covariance * prediction.transition.transpose()).leftCols<3>();
  const Eigen::Matrix3d measured =
      prior.covariance.topLeftCorner<3, 3>() + 1e-6 * Eigen::Matrix3d::Identity();
  const MotionVector expected = cross * measured.inverse() * Eigen::Vector3d(0.02, -0.01, 0.03);
  EXPECT_LT((both[0].state - before.state - expected).norm(), 1e-6);
  const MotionMatrix left = before.covariance - cross * measured.inverse() * cross.transpose();
  EXPECT_LT((both[0].covariance - left).norm(), 1e-6);
  EXPECT_EQ(both[1].state.pose.matrix(), posterior.state.pose.matrix());
}

}  // namespace
}  // namespace lidarena::estimation
