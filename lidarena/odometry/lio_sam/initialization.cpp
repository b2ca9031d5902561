// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/lio_sam/initialization.hpp"

#include <cmath>

namespace lidarena::lio_sam {
namespace {

using Eigen::Vector3d;

// A quiet vehicle: ten times the white noise of a cheap IMU at 200 Hz.
constexpr double kStillGyroSigma = 0.02;  // rad/s
constexpr double kStillAccelSigma = 0.2;  // m/s^2
constexpr double kStillRate = 0.05;       // rad/s: 3 deg/s of first bias
constexpr double kStillForce = 0.3;       // m/s^2 of bias, off gravity's length
constexpr double kAccelInG = 3.0;         // means below this are in units of g
constexpr double kMovingTilt = 0.2;       // rad: what a vehicle's push may tilt gravity by

struct Means {
  Vector3d gyro = Vector3d::Zero();
  Vector3d accel = Vector3d::Zero();
  double gyro_sigma = 0.0;
  double accel_sigma = 0.0;
};

Means means_of(const std::vector<ImuSample>& samples) {
  Means m;
  const auto n = static_cast<double>(samples.size());
  for (const ImuSample& sample : samples) {
    m.gyro += sample.gyro / n;
    m.accel += sample.accel / n;
  }
  for (const ImuSample& sample : samples) {
    m.gyro_sigma += (sample.gyro - m.gyro).squaredNorm() / (3.0 * n);
    m.accel_sigma += (sample.accel - m.accel).squaredNorm() / (3.0 * n);
  }
  m.gyro_sigma = std::sqrt(m.gyro_sigma);
  m.accel_sigma = std::sqrt(m.accel_sigma);
  return m;
}

/// The rotation without yaw that turns `up`, a direction of the body, to z.
Eigen::Matrix3d upright(const Vector3d& up) {
  const Vector3d direction = up.normalized();
  const double pitch = std::asin(std::clamp(-direction.x(), -1.0, 1.0));
  const double roll = std::atan2(direction.y(), direction.z());
  return (Eigen::AngleAxisd(pitch, Vector3d::UnitY()) * Eigen::AngleAxisd(roll, Vector3d::UnitX()))
      .toRotationMatrix();
}

NavState::Matrix covariance_of(bool still) {
  NavState::Vector sigma;
  sigma << Vector3d::Constant(1e-4),            // the start is the frame
      Vector3d::Constant(still ? 0.01 : 3.0),   // m/s
      Vector3d::Constant(1e-4),                 // m
      Vector3d::Constant(still ? 2e-3 : 0.05),  // rad/s
      Vector3d::Constant(0.1);                  // m/s^2
  return sigma.cwiseAbs2().asDiagonal();
}

/// The program's: sure of the biases, not of the velocity.
NavState::Matrix program_covariance() {
  NavState::Vector sigma;
  sigma << Vector3d::Constant(1e-2), Vector3d::Constant(1e4), Vector3d::Constant(1e-2),
      Vector3d::Constant(1e-3), Vector3d::Constant(1e-3);
  return sigma.cwiseAbs2().asDiagonal();
}

}  // namespace

Start start_from(const std::vector<ImuSample>& samples, const Pose& body_from_imu,
                 const Config& config) {
  const Means imu = means_of(samples);
  Start start;
  if (imu.accel.norm() < kAccelInG) start.accel_scale = config.gravity;
  const double force = start.accel_scale * imu.accel.norm();
  start.still = imu.gyro_sigma < kStillGyroSigma &&
                start.accel_scale * imu.accel_sigma < kStillAccelSigma &&
                imu.gyro.norm() < kStillRate && std::abs(force - config.gravity) < kStillForce;
  InertialStart& inertial = start.inertial;
  inertial.gravity = {0.0, 0.0, -config.gravity};
  Pose world_from_body = Pose::Identity();
  if (config.level_start) {
    world_from_body.linear() = upright(body_from_imu.linear() * imu.accel);
    if (start.still) {
      inertial.state.bias.gyro = imu.gyro;
      inertial.state.bias.accel = (force - config.gravity) * imu.accel.normalized();
    }
    inertial.covariance = covariance_of(start.still);
    inertial.gravity_sigma = start.still ? config.gravity_sigma_rad : kMovingTilt;
  } else {
    inertial.covariance = program_covariance();
  }
  inertial.state.world_from_imu = world_from_body * body_from_imu;
  return start;
}

}  // namespace lidarena::lio_sam
