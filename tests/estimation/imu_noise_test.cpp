// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/imu_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace lidarena::estimation {
namespace {

ImuSample sample_at(double t, const Eigen::Vector3d& gyro, const Eigen::Vector3d& accel) {
  ImuSample sample;
  sample.stamp = from_seconds(t);
  sample.gyro = gyro;
  sample.accel = accel;
  return sample;
}

class MeasuredNoiseTest : public testing::TestWithParam<double> {};

TEST_P(MeasuredNoiseTest, OfWhiteNoiseIsItsDensity) {
  const double rate_hz = GetParam(), density = 0.05;
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, density * std::sqrt(rate_hz));
  MeasuredNoise measured;
  double mean_square = 0.0;
  int counted = 0;
  for (int i = 0; i < 20 * static_cast<int>(rate_hz); ++i) {
    const Eigen::Vector3d n(noise(random), noise(random), noise(random));
    measured.add(sample_at(i / rate_hz, 0.1 * n, n));
    if (i < 2 * static_cast<int>(rate_hz)) continue;
    mean_square += std::pow(measured.at_least({}).accel_density, 2);
    ++counted;
  }
  EXPECT_NEAR(std::sqrt(mean_square / counted), density, 0.03 * density);
  const ImuNoise now = measured.at_least({});
  EXPECT_NEAR(now.gyro_density, 0.1 * now.accel_density, 1e-6 * density);
}

INSTANTIATE_TEST_SUITE_P(Rates, MeasuredNoiseTest, testing::Values(100.0, 200.0, 1000.0));

TEST(MeasuredNoise, OfMotionIsFarBelowADataSheets) {
  // 5 rad/s and 15 m/s^2 at 2 Hz, more than a quadcopter at its limits.
  MeasuredNoise measured;
  for (int i = 0; i < 1000; ++i) {
    const double wave = std::sin(2.0 * std::numbers::pi * 2.0 * i / 200.0);
    measured.add(sample_at(i / 200.0, {5.0 * wave, 0.0, 0.0}, {0.0, 15.0 * wave, 9.81}));
  }
  EXPECT_LT(measured.at_least({}).gyro_density, 7.85e-5);
  EXPECT_LT(measured.at_least({}).accel_density, 9.81e-4);
}

TEST(MeasuredNoise, StatedDensitiesHoldWhereTheyAreLarger) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 1.0);
  MeasuredNoise measured;
  for (int i = 0; i < 400; ++i)
    measured.add(sample_at(i / 200.0, Eigen::Vector3d::Zero(), {noise(random), 0.0, 9.81}));
  const ImuNoise told{0.01, 1e-3, 1e-5, 1e-4};
  const ImuNoise both = measured.at_least(told);
  EXPECT_EQ(both.gyro_density, told.gyro_density);
  EXPECT_GT(both.accel_density, 0.02);
  EXPECT_EQ(both.gyro_bias_walk, told.gyro_bias_walk);
  EXPECT_EQ(both.accel_bias_walk, told.accel_bias_walk);
}

TEST(NominalNoise, IsTheLeastOfABetterImuAndLeavesAWorseOneAsItIs) {
  ImuInfo imu;
  imu.gyro_noise_density = 1e-6;
  imu.accel_noise_density = 2e-3;
  imu.gyro_bias_walk = 1e-7;
  imu.accel_bias_walk = 1e-3;
  const ImuInfo least = at_least_nominal(imu);
  EXPECT_EQ(least.gyro_noise_density, 7.85e-5);
  EXPECT_EQ(least.gyro_bias_walk, 1e-5);
  EXPECT_EQ(least.accel_noise_density, 2e-3);
  EXPECT_EQ(least.accel_bias_walk, 1e-3);
}

TEST(MeasuredNoise, AStepAcrossAGapIsNoNoise) {
  MeasuredNoise measured;
  for (int i = 0; i < 400; ++i) {
    const double t = i / 200.0 + (i < 200 ? 0.0 : 0.5);
    measured.add(sample_at(t, Eigen::Vector3d::Zero(), {i < 200 ? 0.0 : 8.0, 0.0, 9.81}));
  }
  EXPECT_LT(measured.at_least({}).accel_density, 1e-12);
}

TEST(CorrectionNoise, IsThatOfTheCorrections) {
  std::mt19937 random(3);
  std::normal_distribution<double> axis(0.0, 5e-3);
  CorrectionNoise noise;
  EXPECT_EQ(noise.density(), 0.0);
  double mean_power = 0.0;  // over 50 s; a mean over 2 s scatters
  for (int i = 0; i < 520; ++i) {
    noise.add({axis(random), axis(random), axis(random)}, 0.1);
    if (i >= 20) mean_power += noise.density() * noise.density() / 500.0;
  }
  EXPECT_NEAR(mean_power, 5e-3 * 5e-3 / 0.1, 0.1 * 5e-3 * 5e-3 / 0.1);
}

TEST(CorrectionNoise, OfAnUpdatesOwnNoiseLittleIsLeftOverALongSpan) {
  // Corrections by a position with white noise: differences of it, which cancel over the span.
  std::mt19937 random(3);
  std::normal_distribution<double> axis(0.0, 0.01);
  CorrectionNoise each, half_second(0.5);
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d now(axis(random), axis(random), axis(random));
    each.add(now - last, 0.1);
    half_second.add(now - last, 0.1);
    last = now;
  }
  EXPECT_LT(half_second.density(), 0.6 * each.density());  // 1 / sqrt(5) expected
}

TEST(CorrectionNoise, GrowsAndFadesOverTwoSeconds) {
  CorrectionNoise noise;
  noise.add({3e-3, 0.0, 0.0}, 0.1);
  EXPECT_NEAR(noise.density(), std::sqrt(0.05 * 3e-3 * 3e-3 / (3.0 * 0.1)), 1e-12);
  for (int i = 0; i < 200; ++i) noise.add(Eigen::Vector3d::Zero(), 0.1);
  EXPECT_LT(noise.density(), 1e-4);
}

}  // namespace
}  // namespace lidarena::estimation
