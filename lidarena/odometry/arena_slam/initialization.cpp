// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_slam/initialization.hpp"

#include "lidarena/estimation/imu_at_rest.hpp"

namespace lidarena::odometry::arena_slam {
namespace {

using Eigen::Vector3d;

constexpr double kMovingTilt = 0.2;  // rad: error of gravity's direction under acceleration

estimation::NavState::Matrix covariance_of(bool still) {
  estimation::NavState::Vector sigma;
  sigma << Vector3d::Constant(1e-4),            // rad; the start defines the frame
      Vector3d::Constant(still ? 0.01 : 3.0),   // m/s
      Vector3d::Constant(1e-4),                 // m
      Vector3d::Constant(still ? 2e-3 : 0.05),  // rad/s
      Vector3d::Constant(0.1);                  // m/s^2
  return sigma.cwiseAbs2().asDiagonal();
}

}  // namespace

Start start_from(const std::vector<ImuSample>& samples, const Pose& body_from_imu, double gravity) {
  const estimation::ImuStatistics imu = estimation::statistics(samples);
  Start start;
  start.accel_scale = estimation::accel_scale_of(imu, gravity);
  start.still = estimation::is_at_rest(imu, gravity, start.accel_scale);
  estimation::InertialStart& inertial = start.inertial;
  inertial.gravity = {0.0, 0.0, -gravity};
  Pose world_from_body = Pose::Identity();
  world_from_body.linear() = estimation::level_rotation(body_from_imu.linear() * imu.mean_accel);
  if (start.still) {
    inertial.state.bias.gyro = imu.mean_gyro;
    inertial.state.bias.accel =
        estimation::accel_bias_along_gravity(imu, gravity, start.accel_scale);
  }
  inertial.covariance = covariance_of(start.still);
  inertial.gravity_sigma = start.still ? kGravitySigma : kMovingTilt;
  inertial.state.world_from_imu = world_from_body * body_from_imu;
  return start;
}

}  // namespace lidarena::odometry::arena_slam
