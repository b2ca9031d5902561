// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "lidarena/base/imu_sample.hpp"
#include "lidarena/base/random.hpp"
#include "lidarena/flight/flight.hpp"
#include "lidarena/sensor/sensor_config.hpp"

namespace lidarena::sensor {

/// Error-free sample of an IMU mounted at `body_from_imu` on a body that moves with `motion`:
/// angular rate, and specific force R^T (a - g) including the lever-arm terms. IMU frame; the stamp
/// is not set.
ImuSample perfect_imu(const flight::Motion& motion, const Pose& body_from_imu);

/// Generates the samples of one IMU in order: sample k at k / rate_hz after the flight's start.
/// Each is the instantaneous value (no averaging over the sample period) with the errors of
/// ImuConfig. Constants of the unit (scale, misalignment, phases of vibration) and the turn-on bias
/// are drawn once. The errors depend only on (config, id, seed); without `noise` the samples are
/// error-free.
class Imu {
 public:
  Imu(const ImuConfig& config, const Pose& body_from_imu, const std::string& id, std::uint64_t seed,
      bool noise);

  /// Stamp of the sample that measure() returns next.
  Time next_stamp() const { return stamp(next_); }
  ImuSample measure(const flight::Flight& flight);

  /// Stamp of the first sample at or after `t`.
  Time first_stamp_from(Time t) const;

 private:
  Time stamp(std::uint64_t sample) const;
  /// Three independent standard normals; `draw` is what they are used for (enum Draw).
  Eigen::Vector3d normals(std::uint64_t sample, std::uint32_t draw) const;
  /// Identity plus scale errors on the diagonal and misalignment angles off the diagonal.
  Eigen::Matrix3d make_response(double scale_error, double misalignment, std::uint32_t draw) const;
  void vibrate(const flight::Motion& motion, ImuSample& sample) const;
  void walk_biases();

  ImuConfig config_;
  Pose body_from_imu_;
  bool noise_;
  CounterRandom random_;
  std::uint64_t next_ = 0;
  Eigen::Matrix3d gyro_response_;
  Eigen::Matrix3d accel_response_;
  Eigen::Vector3d gyro_bias_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel_bias_ = Eigen::Vector3d::Zero();
};

}  // namespace lidarena::sensor
