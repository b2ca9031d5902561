// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lio/initialization.hpp"

#include <gtest/gtest.h>

#include "lidarena/base/random.hpp"
#include "lidarena/base/so3.hpp"
#include "lidarena/base/time.hpp"

namespace lidarena::odometry::arena_lio {
namespace {

Eigen::Vector3d random_vector(SequentialRandom& random, double sigma) {
  const double x = random.normal();
  const double y = random.normal();
  return sigma * Eigen::Vector3d(x, y, random.normal());
}

ImuSample sample_at(double t, const Eigen::Vector3d& gyro = Eigen::Vector3d::Zero(),
                    const Eigen::Vector3d& accel = {0.0, 0.0, 9.80665}) {
  return {from_seconds(t), gyro, accel};
}

std::vector<ImuSample> standing(double accel_unit, double noise) {
  SequentialRandom random(9, 1);
  const Eigen::Matrix3d tilt = so3::exp({0.1, -0.2, 0.0});
  std::vector<ImuSample> samples;
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector3d force = tilt.transpose() * Eigen::Vector3d(0, 0, 9.80665);
    samples.push_back(sample_at(0.005 * i,
                                Eigen::Vector3d(0.01, 0, 0) + random_vector(random, noise),
                                accel_unit * (force + random_vector(random, 10 * noise))));
  }
  return samples;
}

TEST(ArenaLioStart, GravityAndBiasComeFromTheMeans) {
  const Initialization start = start_from(standing(1.0, 1e-3), Pose::Identity()).value();
  EXPECT_TRUE(start.still);
  EXPECT_EQ(start.accel_scale, 1.0);
  const Eigen::Vector3d down = so3::exp({0.1, -0.2, 0.0}).transpose() * Eigen::Vector3d(0, 0, -1);
  EXPECT_LT((start.estimate.state.gravity.normalized() - down).norm(), 2e-3);
  EXPECT_NEAR(start.estimate.state.gravity.norm(), 9.80665, 1e-9);
  EXPECT_NEAR(start.estimate.state.nav.bias.gyro.x(), 0.01, 1e-3);
}

TEST(ArenaLioStart, AccelerationsInGAreRecognized) {
  const Initialization start = start_from(standing(1.0 / 9.80665, 1e-3), Pose::Identity()).value();
  EXPECT_DOUBLE_EQ(start.accel_scale, 9.80665);
  EXPECT_TRUE(start.still);
}

/// Samples of a sensor at rest with a bias of the accelerometer as large as data sheets allow.
std::vector<ImuSample> standing_with(const Eigen::Vector3d& accel_bias) {
  std::vector<ImuSample> samples = standing(1.0, 1e-3);
  for (ImuSample& sample : samples) sample.accel += accel_bias;
  return samples;
}

TEST(ArenaLioStart, AnAccelerometersBiasIsNotTakenForMotion) {
  for (const double bias : {-0.2, -0.07, 0.07, 0.2}) {
    const Eigen::Matrix3d tilt = so3::exp({0.1, -0.2, 0.0});
    const Eigen::Vector3d up = tilt.transpose() * Eigen::Vector3d::UnitZ();
    const std::vector<ImuSample> samples = standing_with(bias * up);
    const estimation::InertialState state =
        start_from(samples, Pose::Identity()).value().estimate.state;
    // The mean of 20 samples with 0.01 m/s^2 of noise: 4.5 sigma.
    EXPECT_LT((state.nav.bias.accel - bias * up).norm(), 0.01);
    StillDetector detector;
    EXPECT_TRUE(detector.observe(estimation::statistics(samples), state, state.position(), 1.0));
  }
}

TEST(ArenaLioStart, ShakingIsNotStanding) {
  const Initialization start = start_from(standing(1.0, 0.1), Pose::Identity()).value();
  EXPECT_FALSE(start.still);
  EXPECT_EQ(start.estimate.state.nav.bias.gyro, Eigen::Vector3d::Zero().eval());
  EXPECT_GT(start.estimate.covariance(estimation::InertialState::kVelocity,
                                      estimation::InertialState::kVelocity),
            1.0);
}

/// What an IMU reads of a constant turn and a constant acceleration, and the states before and
/// after.
struct Maneuver {
  estimation::InertialState first;
  estimation::InertialState last;
  std::vector<estimation::ImuInterval> intervals;
};
Maneuver maneuver() {
  const Eigen::Vector3d rate(0.5, -1.0, 3.0);
  const Eigen::Vector3d acceleration(2.0, -1.0, 4.0);
  Maneuver result;
  estimation::InertialState& first = result.first;
  first.rotation() = so3::exp({0.2, 0.1, -0.3});
  first.nav.velocity = {3.0, -2.0, 0.5};
  first.nav.bias = {{0.01, -0.02, 0.03}, {0.1, 0.2, -0.1}};
  first.gravity = {0.0, 0.0, -9.80665};
  constexpr double kStep = 0.005;
  constexpr int kSteps = 40;
  for (int i = 0; i < kSteps; ++i) {
    const Eigen::Matrix3d middle = first.rotation() * so3::exp((i + 0.5) * kStep * rate);
    result.intervals.push_back(
        {.begin = from_seconds(i * kStep),
         .end = from_seconds((i + 1) * kStep),
         .gyro = rate + first.nav.bias.gyro,
         .accel = middle.transpose() * (acceleration - first.gravity) + first.nav.bias.accel});
  }
  constexpr double kSeconds = kSteps * kStep;
  result.last = first;
  result.last.rotation() = first.rotation() * so3::exp(kSeconds * rate);
  result.last.nav.velocity += kSeconds * acceleration;
  result.last.position() +=
      kSeconds * first.nav.velocity + 0.5 * kSeconds * kSeconds * acceleration;
  return result;
}

TEST(ArenaLioStart, TheTrackBeforeAStateIsTheMotionThatLedToIt) {
  const Maneuver m = maneuver();
  const estimation::ImuTrack track = track_before(m.intervals, m.last, 1.0);
  ASSERT_EQ(track.size(), m.intervals.size());
  const estimation::ImuStep& begin = track.front();
  EXPECT_EQ(begin.begin, Time{0});
  EXPECT_LT(begin.world_from_imu.translation().norm(), 1e-9);
  EXPECT_LT((begin.world_from_imu.linear() - m.first.rotation()).norm(), 1e-9);
  EXPECT_LT((begin.velocity - m.first.nav.velocity).norm(), 1e-9);
  EXPECT_LT(
      (estimation::pose_at(track, m.intervals.back().end).translation() - m.last.position()).norm(),
      1e-9);
}

TEST(ArenaLioStart, WhatALaterScanTellsIsCarriedBack) {
  Maneuver m = maneuver();
  const Eigen::Matrix3d turn =
      so3::exp({0.3, -0.1, 0.2});  // of the frame that the last state is in
  m.last.rotation() = turn * m.last.rotation();
  m.last.nav.velocity = turn * m.last.nav.velocity;
  m.last.gravity = turn * m.last.gravity;
  estimation::InertialState guess = m.first;
  guess.nav.velocity.setZero();
  guess.nav.bias = {};
  guess.gravity = so3::exp({0.5, 0.0, 0.0}) * guess.gravity;
  const estimation::InertialState found = carried_back(m.last, m.intervals, guess, 1.0);
  EXPECT_LT((found.nav.velocity - m.first.nav.velocity).norm(), 1e-9);
  EXPECT_LT((found.gravity - m.first.gravity).norm(), 1e-9);
  EXPECT_EQ(found.nav.bias.gyro, m.first.nav.bias.gyro);
  EXPECT_EQ(found.rotation(), guess.rotation());
  EXPECT_EQ(found.position(), guess.position());
}

TEST(ArenaLioStart, SlowMotionEndsTheStanding) {
  StillDetector detector;
  const estimation::ImuStatistics imu = estimation::statistics(standing(1.0, 1e-3));
  estimation::InertialState state;
  state.nav.bias.gyro = {0.01, 0.0, 0.0};
  state.gravity = so3::exp({0.1, -0.2, 0.0}).transpose() * state.gravity;
  int stood = 0;
  for (int i = 0; i < 20; ++i) {
    state.position().x() = 0.004 * i;  // 4 cm/s: not observable by an IMU
    state.nav.velocity.x() = 0.04;
    stood += detector.observe(imu, state, state.position(), 1.0) ? 1 : 0;
  }
  EXPECT_LT(stood, 19) << "motion should be detected every 3 cm";
  EXPECT_GT(stood, 10);
}

TEST(ArenaLioStart, TheFirstPushEndsTheStanding) {
  estimation::InertialState state;
  state.nav.bias.gyro = {0.01, 0.0, 0.0};
  state.gravity = so3::exp({0.1, -0.2, 0.0}).transpose() * state.gravity;
  std::vector<ImuSample> samples = standing(1.0, 1e-3);
  StillDetector detector;
  EXPECT_TRUE(detector.observe(estimation::statistics(samples), state, state.position(), 1.0));
  for (ImuSample& sample : samples) sample.accel.x() += 0.1;
  EXPECT_FALSE(detector.observe(estimation::statistics(samples), state, state.position(), 1.0))
      << "acceleration of 0.1 m/s^2";
}

TEST(ArenaLioStart, NeedsTenSamplesThatShowAcceleration) {
  std::vector<ImuSample> samples = standing(1.0, 1e-3);
  samples.resize(9);
  EXPECT_FALSE(start_from(samples, Pose::Identity()).has_value());
  samples = standing(0.0, 0.0);
  EXPECT_FALSE(start_from(samples, Pose::Identity()).has_value())
      << "an accelerometer without data";
}

}  // namespace
}  // namespace lidarena::odometry::arena_lio
