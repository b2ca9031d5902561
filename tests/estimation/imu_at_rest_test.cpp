// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/imu_at_rest.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "lidarena/base/so3.hpp"

namespace lidarena::estimation {
namespace {

using Eigen::Vector3d;

constexpr double kGravity = 9.81;

/// Twenty samples of `rate` (rad/s) and `force`, with an error of alternating sign on each axis.
std::vector<ImuSample> samples_of(const Vector3d& rate, const Vector3d& force,
                                  double rate_error = 0.0, double force_error = 0.0) {
  std::vector<ImuSample> samples;
  for (int i = 0; i < 20; ++i) {
    const double sign = i % 2 == 0 ? 1.0 : -1.0;
    samples.push_back({from_seconds(0.005 * i), rate + sign * Vector3d::Constant(rate_error),
                       force + sign * Vector3d::Constant(force_error)});
  }
  return samples;
}

/// Attitude of a body rotated by `pitch` about its y axis and then by `roll` about its x axis.
Eigen::Matrix3d leaning(double pitch, double roll) {
  return so3::exp({0.0, pitch, 0.0}) * so3::exp({roll, 0.0, 0.0});
}

TEST(ImuAtRest, MeanAndSpreadAreThoseOfTheSamples) {
  const ImuStatistics imu = statistics(samples_of({0.1, 0.2, 0.3}, {1.0, 2.0, 3.0}, 0.01, 0.1));
  EXPECT_EQ(imu.count, 20U);
  EXPECT_LT((imu.mean_gyro - Vector3d(0.1, 0.2, 0.3)).norm(), 1e-14);
  EXPECT_LT((imu.mean_accel - Vector3d(1.0, 2.0, 3.0)).norm(), 1e-13);
  EXPECT_NEAR(imu.gyro_sigma, 0.01, 1e-14);
  EXPECT_NEAR(imu.accel_sigma, 0.1, 1e-13);
  const ImuStatistics none = statistics({});
  EXPECT_EQ(none.count, 0U);
  EXPECT_EQ(none.mean_accel, Vector3d::Zero().eval());
}

TEST(ImuAtRest, TheAttitudeAndTheBiasesBehindTheSamplesComeBack) {
  const Vector3d gyro_bias(0.01, -0.02, 0.015);
  for (const double bias : {-0.2, 0.0, 0.2}) {
    for (const double unit : {1.0, kGravity}) {  // of the accelerations, m/s^2
      const Eigen::Matrix3d lean = leaning(-0.4, 2.0);
      const Vector3d up = lean.transpose() * Vector3d::UnitZ();
      const ImuStatistics imu =
          statistics(samples_of(gyro_bias, (kGravity + bias) / unit * up, 1e-3, 1e-2 / unit));
      const double scale = accel_scale_of(imu, kGravity);
      EXPECT_EQ(scale, unit);
      EXPECT_TRUE(is_at_rest(imu, kGravity, scale));
      EXPECT_LT((level_rotation(imu.mean_accel) - lean).norm(), 1e-13);
      EXPECT_LT((imu.mean_gyro - gyro_bias).norm(), 1e-15);
      EXPECT_LT((accel_bias_along_gravity(imu, kGravity, scale) - bias * up).norm(), 1e-13);
    }
  }
}

TEST(ImuAtRest, ABiasAcrossGravityLooksLikeALean) {
  const ImuStatistics imu = statistics(samples_of(Vector3d::Zero(), {0.1, 0.0, kGravity}));
  EXPECT_NEAR(so3::angle(level_rotation(imu.mean_accel)), std::atan(0.1 / kGravity), 1e-13);
  EXPECT_NEAR(accel_bias_along_gravity(imu, kGravity, 1.0).norm(),
              std::hypot(0.1, kGravity) - kGravity, 1e-13);
}

TEST(ImuAtRest, UprightTurnsAnyDirectionToZWithoutYaw) {
  for (const Vector3d& up :
       {Vector3d(0, 0, 1), Vector3d(0, 0, -1), Vector3d(1, 0, 0), Vector3d(-1, 0, 0),
        Vector3d(0, 1, 0), Vector3d(0.3, -0.2, 9.7), Vector3d(-4.0, 5.0, -6.0)}) {
    const Eigen::Matrix3d rotation = level_rotation(up);
    EXPECT_LT((rotation * up.normalized() - Vector3d::UnitZ()).norm(), 1e-14) << up.transpose();
    EXPECT_NEAR(rotation(1, 0), 0.0, 1e-15) << "the body's x axis stays in the x-z plane";
    EXPECT_GT(rotation(0, 0), -1e-15) << "and points forward";
  }
}

TEST(ImuAtRest, WhatMovesOrIsTooShortDoesNotStand) {
  const Vector3d up(0.0, 0.0, kGravity);
  const auto standing = [](const std::vector<ImuSample>& samples) {
    return is_at_rest(statistics(samples), kGravity, 1.0);
  };
  const Vector3d none = Vector3d::Zero();
  EXPECT_TRUE(standing(samples_of(none, up, 0.015, 0.15)));
  EXPECT_FALSE(standing(samples_of(none, up, 0.025, 0.0))) << "varying rate";
  EXPECT_FALSE(standing(samples_of(none, up, 0.0, 0.25))) << "varying force";
  EXPECT_FALSE(standing(samples_of({0.0, 0.0, 0.06}, up))) << "constant rotation";
  EXPECT_FALSE(standing(samples_of(none, 1.04 * up))) << "force too large";
  EXPECT_FALSE(standing(samples_of(none, 0.96 * up))) << "force too small";
  EXPECT_TRUE(standing(samples_of(none, up + Vector3d(1.0, 0.0, 0.0))))
      << "a horizontal force is not detected";
  EXPECT_FALSE(standing({{Time{0}, none, up}, {Time{1}, none, up}})) << "two samples are too few";
  EXPECT_FALSE(standing({}));
}

}  // namespace
}  // namespace lidarena::estimation
