// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/fast_lio2/propagation.hpp"

#include <gtest/gtest.h>

#include "lidarena/base/so3.hpp"
#include "lidarena/base/time.hpp"

namespace lidarena::odometry::fast_lio2 {
namespace {

using State = estimation::InertialState;

const Eigen::Vector3d kUp(0.0, 0.0, 9.8);

estimation::StateEstimate moving_at(const Eigen::Vector3d& velocity) {
  estimation::StateEstimate estimate;
  estimate.covariance.setZero();
  estimate.state.gravity = -kUp;
  estimate.state.nav.velocity = velocity;
  return estimate;
}

ImuSample sample_at(double seconds, const Eigen::Vector3d& gyro, const Eigen::Vector3d& accel) {
  return {from_seconds(seconds), gyro, accel};
}

TEST(FastLio2Propagation, StepsUseTheMeanOfTwoSamplesAndTheRestTheLastMean) {
  const std::vector<ImuSample> samples{sample_at(0.99, {0, 0, 0.2}, kUp),
                                       sample_at(1.02, {0, 0, 0.4}, kUp),
                                       sample_at(1.06, {0, 0, 1.0}, kUp)};
  estimation::StateEstimate estimate = moving_at({1, 0, 0});
  propagate_forward(samples, {from_seconds(1.0), from_seconds(1.0), from_seconds(1.1)}, {},
                    estimate);
  const double angle = 0.02 * 0.3 + 0.04 * 0.7 + 0.04 * 0.7;
  EXPECT_LT(so3::angle(so3::exp({0, 0, angle}).transpose() * estimate.state.rotation()), 1e-12);
  EXPECT_NEAR(estimate.state.position().x(), 0.1, 1e-12);
  EXPECT_NEAR(estimate.state.nav.velocity.x(), 1.0, 1e-12) << "only gravity acts";
}

TEST(FastLio2Propagation, ThePositionIsIntegratedToFirstOrder) {
  std::vector<ImuSample> samples;
  for (int i = 0; i <= 10; ++i)
    samples.push_back(sample_at(0.01 * i, {0, 0, 0}, kUp + Eigen::Vector3d(2, 0, 0)));
  estimation::StateEstimate estimate = moving_at({0, 0, 0});
  propagate_forward(samples, {Time{0}, Time{0}, from_seconds(0.1)}, {}, estimate);
  EXPECT_NEAR(estimate.state.nav.velocity.x(), 0.2, 1e-12);
  // Sum of v dt with the velocity at the begin of each of 10 steps; exact would be 0.01 m.
  EXPECT_NEAR(estimate.state.position().x(), 0.01 * 0.02 * 45, 1e-12);
}

TEST(FastLio2Propagation, TheNoiseOfASampleDoesNotDependOnItsDurationButOnTheirNumber) {
  Config config;
  config.gyro_variance = 0.3;
  config.accel_variance = 0.5;
  config.gyro_bias_variance = 0.0;  // else it reaches the attitude in the second step
  const auto covariance_after = [&](int steps) {
    std::vector<ImuSample> samples;
    for (int i = 0; i <= steps; ++i) samples.push_back(sample_at(0.1 * i / steps, {0, 0, 0}, kUp));
    estimation::StateEstimate estimate = moving_at({0, 0, 0});
    propagate_forward(samples, {Time{0}, Time{0}, from_seconds(0.1)}, config, estimate);
    return estimate.covariance;
  };
  const auto p = covariance_after(1);
  EXPECT_NEAR(p(State::kRotation, State::kRotation), 0.3 * 0.1 * 0.1, 1e-12);
  EXPECT_NEAR(p(State::kVelocity, State::kVelocity), 0.5 * 0.1 * 0.1, 1e-12);
  EXPECT_NEAR(covariance_after(2)(State::kRotation, State::kRotation), 0.5 * 0.3 * 0.1 * 0.1, 1e-12)
      << "twice the samples halve it";
}

TEST(FastLio2Propagation, TheTrackBeginsAtTheScanWithThePoseOfTheEndBefore) {
  const std::vector<ImuSample> samples{sample_at(0.99, {0, 0, 0}, kUp),
                                       sample_at(1.02, {0, 0, 0}, kUp),
                                       sample_at(1.06, {0, 0, 0}, kUp)};
  estimation::StateEstimate estimate = moving_at({1, 0, 0});
  // The scan before ended 3 ms too early.
  const auto track = propagate_forward(
      samples, {from_seconds(0.997), from_seconds(1.0), from_seconds(1.1)}, {}, estimate);
  ASSERT_EQ(track.size(), 2U) << "the rest after the last sample is a continuation of its step";
  EXPECT_EQ(track[0].begin, from_seconds(1.0));
  EXPECT_EQ(track[0].world_from_imu.translation().x(), 0.0);
  EXPECT_EQ(track[1].begin, from_seconds(1.02));
  EXPECT_NEAR(track[1].world_from_imu.translation().x(), 0.023, 1e-12);
  EXPECT_NEAR(estimate.state.position().x(), 0.103, 1e-12);
}

TEST(FastLio2Propagation, WithoutNewSamplesTheVelocityStays) {
  estimation::StateEstimate estimate = moving_at({1, -2, 0});
  const std::vector<ImuSample> old{sample_at(0.9, {0, 0, 0}, {5, 5, 5})};
  for (const std::vector<ImuSample>& samples : {old, std::vector<ImuSample>{}}) {
    const auto track = propagate_forward(
        samples, {from_seconds(1.0), from_seconds(1.0), from_seconds(1.1)}, {}, estimate);
    EXPECT_EQ(track.size(), 1U);
    EXPECT_LT((estimate.state.nav.velocity - Eigen::Vector3d(1, -2, 0)).norm(), 1e-12);
  }
  EXPECT_NEAR(estimate.state.position().y(), -0.4, 1e-12);
}

}  // namespace
}  // namespace lidarena::odometry::fast_lio2
