// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lio/initialization.hpp"

#include <cmath>

namespace lidarena::odometry::arena_lio {
namespace {

using State = estimation::InertialState;

// Maximum values at a standstill.
constexpr double kMaxStillDistance = 0.03;  // m
constexpr double kMaxStillSpeed = 0.05;     // m/s
// Of a scan's mean IMU readings minus those expected at rest: detects the first acceleration.
constexpr double kMaxStillRate = 0.005;  // rad/s
constexpr double kMaxStillForce = 0.05;  // m/s^2

void set_sigma(State::Matrix& covariance, State::Block block, int size, double sigma) {
  covariance.diagonal().segment(block, size).setConstant(sigma * sigma);
}

State::Matrix covariance_of(const Config& config, bool still) {
  State::Matrix p = State::Matrix::Zero();
  const double extrinsic = std::sqrt(1e-5);
  set_sigma(p, State::kLidarRotation, 3, extrinsic);
  set_sigma(p, State::kLidarPosition, 3, extrinsic);
  if (config.initial_sigma > 0.0) {  // as in the published program
    set_sigma(p, State::kPosition, 3, config.initial_sigma);
    set_sigma(p, State::kRotation, 3, config.initial_sigma);
    set_sigma(p, State::kVelocity, 3, config.initial_sigma);
    set_sigma(p, State::kGyroBias, 3, 1e-2);
    set_sigma(p, State::kAccelBias, 3, std::sqrt(1e-3));
    set_sigma(p, State::kGravity, 2, std::sqrt(1e-5));
    return p;
  }
  set_sigma(p, State::kPosition, 3, 1e-4);  // the start is the origin
  set_sigma(p, State::kRotation, 3, 1e-4);
  set_sigma(p, State::kVelocity, 3, still ? 0.01 : 3.0);
  set_sigma(p, State::kGyroBias, 3, still ? 1e-3 : 0.05);
  set_sigma(p, State::kAccelBias, 3, 0.1);
  set_sigma(p, State::kGravity, 2, still ? 0.02 : 0.2);
  return p;
}

}  // namespace

Start start_from(const std::vector<ImuSample>& samples, const Pose& imu_from_lidar,
                 const Config& config) {
  const estimation::ImuStatistics imu = estimation::statistics(samples);
  Start start;
  start.accel_scale = config.always_scale_accel ? config.gravity / imu.mean_accel.norm()
                                                : estimation::accel_scale_of(imu, config.gravity);
  start.still = estimation::is_at_rest(imu, config.gravity, start.accel_scale);
  State& state = start.estimate.state;
  state.gravity = -config.gravity * imu.mean_accel.normalized();
  if (start.still || config.initial_sigma > 0.0) state.nav.bias.gyro = imu.mean_gyro;
  if (start.still && !config.always_scale_accel)  // else the scale contains it
    state.nav.bias.accel =
        estimation::accel_bias_along_gravity(imu, config.gravity, start.accel_scale);
  state.imu_from_lidar.linear() = imu_from_lidar.linear();
  state.imu_from_lidar.translation() = imu_from_lidar.translation();
  start.estimate.covariance = covariance_of(config, start.still);
  return start;
}

bool StillDetector::observe(const estimation::ImuStatistics& imu,
                            const estimation::InertialState& predicted,
                            const Eigen::Vector3d& position, const Config& config,
                            double accel_scale) {
  const Eigen::Vector3d at_rest =
      predicted.nav.bias.accel - predicted.rotation().transpose() * predicted.gravity;
  const bool is_still = estimation::is_at_rest(imu, config.gravity, accel_scale) &&
                        (imu.mean_gyro - predicted.nav.bias.gyro).norm() < kMaxStillRate &&
                        (accel_scale * imu.mean_accel - at_rest).norm() < kMaxStillForce &&
                        predicted.nav.velocity.norm() < kMaxStillSpeed &&
                        (scans_ == 0 || (position - anchor_).norm() < kMaxStillDistance);
  if (is_still && scans_ == 0) anchor_ = position;
  scans_ = is_still ? scans_ + 1 : 0;
  return is_still;
}

}  // namespace lidarena::odometry::arena_lio
