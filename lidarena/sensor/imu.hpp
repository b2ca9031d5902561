// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "lidarena/base/imu_sample.hpp"
#include "lidarena/base/random.hpp"
#include "lidarena/flight/flight.hpp"
#include "lidarena/sensor/sensor_config.hpp"

namespace lidarena {

/// What a perfect IMU at `body_from_imu` feels while its body moves as `motion` says: the rate, and
/// the specific force R^T (a - g) with the lever arm's share. IMU frame; no stamp.
ImuSample perfect_imu(const Motion& motion, const Pose& body_from_imu);

/// One IMU's samples, one after the other: sample k at k / rate_hz since the flight's start. Each
/// is the instant's value (no averaging over the sample period) with the errors of ImuConfig. What
/// is fixed for a unit (scale, misalignment, phases of vibration) and its turn-on bias are drawn
/// once. Depends on (config, id, seed) alone; without `noise` the samples are perfect.
class Imu {
 public:
  Imu(const ImuConfig& config, const Pose& body_from_imu, const std::string& id, std::uint64_t seed,
      bool noise);

  /// Instant of the sample that measure() gives next.
  Time next_stamp() const { return stamp(next_); }
  ImuSample measure(const Flight& flight);

  /// Instant of the first sample at or after `t`.
  Time first_stamp_from(Time t) const;

 private:
  Time stamp(std::uint64_t sample) const;
  /// Three independent standard normals; `draw` tells the purposes apart.
  Eigen::Vector3d normals(std::uint64_t sample, std::uint32_t draw) const;
  /// I with scale errors on its diagonal and the axes' small angles beside it.
  Eigen::Matrix3d make_response(double scale_error, double misalignment, std::uint32_t draw) const;
  void vibrate(const Motion& motion, ImuSample& sample) const;
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

}  // namespace lidarena
