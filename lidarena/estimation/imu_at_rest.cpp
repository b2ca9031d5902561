// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/imu_at_rest.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace lidarena::estimation {
namespace {

using Eigen::Vector3d;

// Limits for a vehicle at rest. Sigmas: ten times the white noise of a low-cost IMU at 200 Hz.
constexpr double kStillGyroSigma = 0.02;  // rad/s
constexpr double kStillAccelSigma = 0.2;  // m/s^2
constexpr double kStillRate = 0.05;       // rad/s: a turn-on bias of 3 deg/s
constexpr double kStillForce = 0.3;       // m/s^2: bias along gravity
constexpr double kAccelInG = 3.0;         // mean accelerations of a norm below this are in g

}  // namespace

ImuStatistics statistics(const std::vector<ImuSample>& samples) {
  ImuStatistics s;
  s.count = samples.size();
  if (samples.empty()) return s;
  const auto n = static_cast<double>(s.count);
  for (const ImuSample& sample : samples) {
    s.mean_gyro += sample.gyro / n;
    s.mean_accel += sample.accel / n;
  }
  double gyro = 0.0;
  double accel = 0.0;
  for (const ImuSample& sample : samples) {
    gyro += (sample.gyro - s.mean_gyro).squaredNorm();
    accel += (sample.accel - s.mean_accel).squaredNorm();
  }
  s.gyro_sigma = std::sqrt(gyro / (3.0 * n));
  s.accel_sigma = std::sqrt(accel / (3.0 * n));
  return s;
}

double accel_scale_of(const ImuStatistics& imu, double gravity) {
  return imu.mean_accel.norm() < kAccelInG ? gravity : 1.0;
}

bool is_at_rest(const ImuStatistics& imu, double gravity, double accel_scale) {
  return imu.count > 2 && imu.gyro_sigma < kStillGyroSigma &&
         accel_scale * imu.accel_sigma < kStillAccelSigma && imu.mean_gyro.norm() < kStillRate &&
         std::abs(accel_scale * imu.mean_accel.norm() - gravity) < kStillForce;
}

Vector3d accel_bias_along_gravity(const ImuStatistics& imu, double gravity, double accel_scale) {
  const double too_long = accel_scale * imu.mean_accel.norm() - gravity;
  return too_long * imu.mean_accel.normalized();
}

Eigen::Matrix3d level_rotation(const Vector3d& up) {
  const Vector3d direction = up.normalized();
  const double pitch = std::asin(std::clamp(-direction.x(), -1.0, 1.0));
  const double roll = std::atan2(direction.y(), direction.z());
  return (Eigen::AngleAxisd(pitch, Vector3d::UnitY()) * Eigen::AngleAxisd(roll, Vector3d::UnitX()))
      .toRotationMatrix();
}

}  // namespace lidarena::estimation
