// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_slam/initialization.hpp"

#include <gtest/gtest.h>

#include "lidarena/base/so3.hpp"

namespace lidarena::odometry::arena_slam {
namespace {

using Eigen::Vector3d;

constexpr double kGravity = 9.80665;  // m/s^2

std::vector<ImuSample> resting(const Vector3d& force, const Vector3d& rate) {
  std::vector<ImuSample> samples;
  for (int i = 0; i < 20; ++i) samples.push_back({from_seconds(0.005 * i), rate, force});
  return samples;
}

TEST(ArenaSlamStart, FeelsHowTheBodyLeansAndHowTheImuIsMounted) {
  const Eigen::Matrix3d lean = so3::exp({0.0, 0.2, 0.0}) * so3::exp({0.1, 0.0, 0.0});
  const Pose body_from_imu = make_pose(so3::exp({0.5, -0.3, 1.0}), {0.1, 0.0, 0.0});
  const Vector3d force = (lean * body_from_imu.linear()).transpose() * Vector3d(0, 0, 9.81);
  const Start start = start_from(resting(force, {0.01, 0.0, -0.01}), body_from_imu, kGravity);
  EXPECT_TRUE(start.still);
  const Pose world_from_body = start.inertial.state.world_from_imu * body_from_imu.inverse();
  EXPECT_LT((world_from_body.linear() - lean).norm(), 1e-9) << "no yaw";
  EXPECT_LT(world_from_body.translation().norm(), 1e-12);
  EXPECT_LT((start.inertial.state.bias.gyro - Vector3d(0.01, 0.0, -0.01)).norm(), 1e-12);
  EXPECT_EQ(start.accel_scale, 1.0);
}

TEST(ArenaSlamStart, WhatTheForceAtRestIsTooLongByIsTheAccelerometersBias) {
  const Vector3d up = Vector3d(0.1, -0.05, 1.0).normalized();
  const Start start =
      start_from(resting((kGravity + 0.07) * up, Vector3d::Zero()), Pose::Identity(), kGravity);
  EXPECT_LT((start.inertial.state.bias.accel - 0.07 * up).norm(), 1e-12);
}

TEST(ArenaSlamStart, AccelerationsInUnitsOfGAreScaled) {
  const Start start =
      start_from(resting({0.0, 0.0, 1.0}, Vector3d::Zero()), Pose::Identity(), kGravity);
  EXPECT_EQ(start.accel_scale, kGravity);
  EXPECT_TRUE(start.still);
}

TEST(ArenaSlamStart, InMotionNothingButTheTiltIsTaken) {
  std::vector<ImuSample> samples = resting({0.0, 0.0, kGravity}, {0.01, 0.0, 0.0});
  for (std::size_t i = 0; i < samples.size(); i += 2) samples[i].accel.x() = 3.0;
  const Start start = start_from(samples, Pose::Identity(), kGravity);
  EXPECT_FALSE(start.still);
  EXPECT_TRUE(start.inertial.state.bias.gyro.isZero());
  EXPECT_GT(start.inertial.gravity_sigma, kGravitySigma);
}

}  // namespace
}  // namespace lidarena::odometry::arena_slam
