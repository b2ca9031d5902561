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
  const Start start = start_from(standing(1.0, 1e-3), Pose::Identity()).value();
  EXPECT_TRUE(start.still);
  EXPECT_EQ(start.accel_scale, 1.0);
  const Eigen::Vector3d down = so3::exp({0.1, -0.2, 0.0}).transpose() * Eigen::Vector3d(0, 0, -1);
  EXPECT_LT((start.estimate.state.gravity.normalized() - down).norm(), 2e-3);
  EXPECT_NEAR(start.estimate.state.gravity.norm(), 9.80665, 1e-9);
  EXPECT_NEAR(start.estimate.state.nav.bias.gyro.x(), 0.01, 1e-3);
}

TEST(ArenaLioStart, AccelerationsInGAreRecognized) {
  const Start start = start_from(standing(1.0 / 9.80665, 1e-3), Pose::Identity()).value();
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
  const Start start = start_from(standing(1.0, 0.1), Pose::Identity()).value();
  EXPECT_FALSE(start.still);
  EXPECT_EQ(start.estimate.state.nav.bias.gyro, Eigen::Vector3d::Zero().eval());
  EXPECT_GT(start.estimate.covariance(estimation::InertialState::kVelocity,
                                      estimation::InertialState::kVelocity),
            1.0);
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
