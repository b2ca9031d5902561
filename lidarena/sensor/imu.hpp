// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "lidarena/base/imu_sample.hpp"
#include "lidarena/base/random.hpp"
#include "lidarena/flight/flight.hpp"
#include "lidarena/sensor/low_pass.hpp"
#include "lidarena/sensor/sensor_clock.hpp"
#include "lidarena/sensor/sensor_config.hpp"
#include "lidarena/sensor/vibration.hpp"

namespace lidarena::sensor {

/// Error-free sample of an IMU mounted at `body_from_imu` on a body that moves with `motion`:
/// angular rate, and specific force R^T (a - g) including the lever-arm terms. IMU frame; the stamp
/// is not set.
ImuSample perfect_imu(const flight::Motion& motion, const Pose& body_from_imu,
                      double gravity = flight::kGravity);

/// Generates the samples of one IMU in order: sample k at k / rate_hz after the flight's start.
/// Each is the instantaneous value (no averaging over the sample period, unless the IMU has a
/// bandwidth) with the errors of ImuConfig. Constants of the unit (scale, misalignment, phases of
/// vibration, ...) and the turn-on bias are drawn once. The errors depend only on (config, id,
/// seed); without `noise` the samples are error-free, but for gravity.
class Imu {
 public:
  /// `clock` is that of the LiDAR around the IMU; the stamps have its offset and drift.
  Imu(const ImuConfig& config, const Pose& body_from_imu, const std::string& id, std::uint64_t seed,
      bool noise, const ClockConfig& clock = {});

  /// Stamp of the sample that measure() returns next: the next one that is not lost.
  Time next_stamp() const { return stamp(delivered_from(next_)); }
  /// True time of that sample.
  Time next_true_time() const { return true_time(delivered_from(next_)); }
  ImuSample measure(const flight::Flight& flight);

  /// Stamp of the first sample at or after `t`.
  Time first_stamp_from(Time t) const;

 private:
  Time true_time(std::uint64_t sample) const;
  Time stamp(std::uint64_t sample) const { return clock_.stamp(sample, true_time(sample)); }
  bool is_lost(std::uint64_t sample) const;
  /// The first sample from `sample` on that is not lost.
  std::uint64_t delivered_from(std::uint64_t sample) const;
  /// Three independent standard normals; `draw` is what they are used for (enum Draw).
  Eigen::Vector3d normals(std::uint64_t sample, std::uint32_t draw) const;
  /// Identity plus scale errors on the diagonal and misalignment angles off the diagonal.
  Eigen::Matrix3d make_response(double scale_error, double misalignment, std::uint32_t draw) const;
  Eigen::Matrix3d make_g_sensitivity() const;
  /// What the IMU feels at `t`, with vibration.
  ImuSample felt(const flight::Flight& flight, Time t, const Vibration::Gains& gains) const;
  /// The same at sample next_, delayed and low-pass filtered.
  ImuSample sampled(const flight::Flight& flight);
  void walk_biases();
  void distort(ImuSample& sample) const;
  /// Measures sample next_, whether it is lost or not.
  ImuSample measure_next(const flight::Flight& flight);

  ImuConfig config_;
  Pose body_from_imu_;
  bool noise_;
  SensorClock clock_;
  CounterRandom random_;
  CounterRandom loss_, response_;
  Vibration vibration_;
  std::optional<LowPass> low_pass_;
  std::uint64_t steps_ = 1;  ///< values that the low-pass takes per sample
  std::uint64_t next_ = 0;
  Eigen::Matrix3d gyro_response_;
  Eigen::Matrix3d accel_response_;
  Eigen::Matrix3d g_sensitivity_;
  Eigen::Vector3d gyro_curve_, accel_curve_;  ///< quadratic errors, 1 / (unit of the sample)
  Eigen::Vector3d gyro_bias_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel_bias_ = Eigen::Vector3d::Zero();
};

}  // namespace lidarena::sensor
