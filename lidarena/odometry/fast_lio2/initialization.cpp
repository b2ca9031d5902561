// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/fast_lio2/initialization.hpp"

#include "lidarena/estimation/imu_at_rest.hpp"

namespace lidarena::odometry::fast_lio2 {
namespace {

using State = estimation::InertialState;

constexpr std::size_t kSamples = 10;         // in the mean, at least
constexpr double kMeanAccel = 9.81;          // m/s^2, of the scaled accelerations at rest
constexpr double kGravity = 9.809;           // m/s^2, radius of the sphere of gravities
constexpr double kPoseVariance = 1.0;        // m^2, rad^2, and (m/s)^2 of the velocity
constexpr double kExtrinsicVariance = 1e-5;  // rad^2, m^2
constexpr double kGyroBiasVariance = 1e-4;   // (rad/s)^2
constexpr double kAccelBiasVariance = 1e-3;  // (m/s^2)^2
constexpr double kGravityVariance = 1e-5;    // rad^2

State::Matrix initial_covariance() {
  State::Vector variances = State::Vector::Constant(kPoseVariance);
  variances.segment<3>(State::kLidarRotation).setConstant(kExtrinsicVariance);
  variances.segment<3>(State::kLidarPosition).setConstant(kExtrinsicVariance);
  variances.segment<3>(State::kGyroBias).setConstant(kGyroBiasVariance);
  variances.segment<3>(State::kAccelBias).setConstant(kAccelBiasVariance);
  variances.segment<2>(State::kGravity).setConstant(kGravityVariance);
  return variances.asDiagonal();
}

}  // namespace

std::optional<Start> start_from(const std::vector<ImuSample>& samples, const Pose& imu_from_lidar) {
  const estimation::ImuStatistics imu = estimation::statistics(samples);
  const double force = imu.mean_accel.norm();
  if (imu.count < kSamples || !(force > 0.0)) return std::nullopt;
  Start start;
  start.accel_scale = kMeanAccel / force;
  start.estimate.covariance = initial_covariance();
  State& state = start.estimate.state;
  state.imu_from_lidar = imu_from_lidar;
  state.nav.bias.gyro = imu.mean_gyro;
  state.gravity = -kGravity / force * imu.mean_accel;
  return start;
}

}  // namespace lidarena::odometry::fast_lio2
