// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/ct_icp/prediction.hpp"

#include <gtest/gtest.h>

#include "lidarena/base/so3.hpp"

namespace lidarena::odometry::ct_icp {
namespace {

Pose step_of(double yaw, double x) { return make_pose(so3::exp({0, 0, yaw}), {x, 0.0, 0.0}); }

void expect_near(const Pose& a, const Pose& b) {
  EXPECT_LT((a.matrix() - b.matrix()).norm(), 1e-12);
}

TEST(CtIcpPrediction, BeginsAtRestAtTheOrigin) {
  for (const auto way : {InitialMotion::kLastPose, InitialMotion::kConstantMotion}) {
    const ElasticMotion guess = MotionHistory{}.predict(way);
    expect_near(guess.begin, Pose::Identity());
    expect_near(guess.end, Pose::Identity());
  }
}

TEST(CtIcpPrediction, TheThirdScanBeginsWhereTheRigidSecondEnded) {
  const Pose end = step_of(0.1, 1.0);
  MotionHistory history;
  history.add(ElasticMotion::still(Pose::Identity()));
  history.add({Pose::Identity(), end});  // a rigid scan leaves its begin where it was
  const ElasticMotion guess = history.predict(InitialMotion::kConstantMotion);
  expect_near(guess.begin, end);
  expect_near(guess.end, end * end);
}

TEST(CtIcpPrediction, LaterEachEndRepeatsItsOwnMotion) {
  const Pose step = step_of(0.1, 1.0);
  const Pose gap = step_of(0.01, 0.05);  // between the end of a scan and the begin of the next
  MotionHistory history;
  Pose begin = Pose::Identity();
  for (int i = 0; i < 3; ++i) {
    history.add({begin, begin * step});
    begin = begin * step * gap;
  }
  const Pose last_begin = step * gap * step * gap;
  const ElasticMotion guess = history.predict(InitialMotion::kConstantMotion);
  expect_near(guess.begin, last_begin * (step * gap));
  expect_near(guess.end, last_begin * step * (gap * step));
  const ElasticMotion still = history.predict(InitialMotion::kLastPose);
  expect_near(still.begin, last_begin * step);
  expect_near(still.end, last_begin * step);
}

TEST(CtIcpPrediction, ThePriorExpectsTheLastEndAndTheLastTranslation) {
  const Pose begin = step_of(0.2, 1.0);
  MotionHistory history;
  history.add({begin, begin * step_of(0.1, 0.5)});
  PriorConfig weights;
  weights.orientation = 0.25;
  weights.small_velocity = 0.5;
  const MotionPrior prior = history.prior(weights);
  expect_near(prior.begin, history.last_end());
  EXPECT_LT((prior.step - begin.linear() * Eigen::Vector3d(0.5, 0, 0)).norm(), 1e-12);
  EXPECT_EQ(prior.location, 0.001);
  EXPECT_EQ(prior.velocity, 0.001);
  EXPECT_EQ(prior.orientation, 0.25);
  EXPECT_EQ(prior.small_velocity, 0.5);
}

}  // namespace
}  // namespace lidarena::odometry::ct_icp
