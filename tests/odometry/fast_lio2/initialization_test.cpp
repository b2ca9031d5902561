// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/fast_lio2/initialization.hpp"

#include <gtest/gtest.h>

#include "lidarena/base/so3.hpp"
#include "lidarena/base/time.hpp"

namespace lidarena::odometry::fast_lio2 {
namespace {

using State = estimation::InertialState;

std::vector<ImuSample> resting(std::size_t count, const Eigen::Vector3d& accel) {
  std::vector<ImuSample> samples;
  for (std::size_t i = 0; i < count; ++i)
    samples.push_back({from_seconds(0.005 * static_cast<double>(i)), {0.01, -0.02, 0.03}, accel});
  return samples;
}

TEST(FastLio2Start, TheMeanForceIsGravityAndTheMeanRateTheBias) {
  const Eigen::Vector3d force = so3::exp({0.1, -0.2, 0.0}) * Eigen::Vector3d(0, 0, 9.9);
  const Pose imu_from_lidar = make_pose(so3::exp({0.3, 0.1, -0.2}), {0.1, 0.2, 0.3});
  const Start start = start_from(resting(20, force), imu_from_lidar).value();
  const State& state = start.estimate.state;
  EXPECT_LT((state.gravity + 9.809 / 9.9 * force).norm(), 1e-9);
  EXPECT_LT((state.nav.bias.gyro - Eigen::Vector3d(0.01, -0.02, 0.03)).norm(), 1e-12);
  EXPECT_EQ(state.nav.bias.accel, Eigen::Vector3d::Zero().eval()) << "it is in the scale";
  EXPECT_EQ(state.world_from_imu().matrix(), Pose::Identity().matrix());
  EXPECT_EQ(state.imu_from_lidar.matrix(), imu_from_lidar.matrix());
  EXPECT_NEAR((start.accel_scale * force).norm(), 9.81, 1e-9);
  EXPECT_NEAR(start_from(resting(20, force / 9.9), imu_from_lidar)->accel_scale, 9.81, 1e-9)
      << "in g";
}

TEST(FastLio2Start, TheCovarianceIsThatOfTheProgram) {
  const auto p = start_from(resting(20, {0, 0, 9.8}), Pose::Identity())->estimate.covariance;
  EXPECT_EQ(p(State::kPosition, State::kPosition), 1.0);
  EXPECT_EQ(p(State::kRotation + 2, State::kRotation + 2), 1.0);
  EXPECT_EQ(p(State::kVelocity, State::kVelocity), 1.0);
  EXPECT_EQ(p(State::kLidarPosition, State::kLidarPosition), 1e-5);
  EXPECT_EQ(p(State::kGyroBias, State::kGyroBias), 1e-4);
  EXPECT_EQ(p(State::kAccelBias + 2, State::kAccelBias + 2), 1e-3);
  EXPECT_EQ(p(State::kGravity + 1, State::kGravity + 1), 1e-5);
  EXPECT_TRUE(p.isDiagonal());
}

TEST(FastLio2Start, NeedsTenSamplesThatShowAcceleration) {
  EXPECT_FALSE(start_from(resting(9, {0, 0, 9.8}), Pose::Identity()).has_value());
  EXPECT_TRUE(start_from(resting(10, {0, 0, 9.8}), Pose::Identity()).has_value());
  EXPECT_FALSE(start_from(resting(20, {0, 0, 0}), Pose::Identity()).has_value());
  EXPECT_FALSE(start_from({}, Pose::Identity()).has_value());
}

}  // namespace
}  // namespace lidarena::odometry::fast_lio2
