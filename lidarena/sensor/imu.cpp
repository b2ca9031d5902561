// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/imu.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lidarena::sensor {
namespace {

/// What random numbers are used for. Each purpose takes two counters, see normals(); constants of a
/// unit are drawn with sample 0 only.
enum ImuDraw : std::uint32_t {
  kGyroNoise,
  kAccelNoise,
  kGyroBias,
  kAccelBias,
  kGyroResponse,
  kAccelResponse = kGyroResponse + 3,
  kVibration = kAccelResponse + 3
};

/// Output of the analog-to-digital converter for `value`.
Eigen::Vector3d digitized(const Eigen::Vector3d& value, double range, double resolution) {
  Eigen::Vector3d read = value;
  if (resolution > 0.0) read = (value / resolution).array().round() * resolution;
  if (range > 0.0) read = read.cwiseMax(-range).cwiseMin(range);
  return read;
}

}  // namespace

ImuSample perfect_imu(const flight::Motion& motion, const Pose& body_from_imu) {
  const Eigen::Vector3d gravity_world(0.0, 0.0, -flight::kGravity);
  const Eigen::Vector3d& rate = motion.angular_rate_body;
  const Eigen::Vector3d arm = body_from_imu.translation();
  const Eigen::Vector3d lever_arm_force =
      motion.angular_acceleration_body.cross(arm) + rate.cross(rate.cross(arm));
  const Eigen::Vector3d force_body =
      motion.world_from_body.linear().transpose() * (motion.acceleration_world - gravity_world) +
      lever_arm_force;
  ImuSample sample;
  sample.gyro = body_from_imu.linear().transpose() * rate;
  sample.accel = body_from_imu.linear().transpose() * force_body;
  return sample;
}

Imu::Imu(const ImuConfig& config, const Pose& body_from_imu, const std::string& id,
         std::uint64_t seed, bool noise)
    : config_(config),
      body_from_imu_(body_from_imu),
      noise_(noise),
      random_(seed, stream_of((id + "/imu").c_str())),
      gyro_response_(
          make_response(config.gyro_scale_error, config.gyro_misalignment, kGyroResponse)),
      accel_response_(
          make_response(config.accel_scale_error, config.accel_misalignment, kAccelResponse)) {}

Time Imu::stamp(std::uint64_t sample) const {
  return from_seconds(static_cast<double>(sample) / config_.rate_hz);
}

Time Imu::first_stamp_from(Time t) const {
  auto sample = static_cast<std::uint64_t>(std::max(0.0, to_seconds(t) * config_.rate_hz));
  while (sample > 0 && stamp(sample) >= t) --sample;  // may be off by one due to rounding
  while (stamp(sample) < t) ++sample;
  return stamp(sample);
}

Eigen::Vector3d Imu::normals(std::uint64_t sample, std::uint32_t draw) const {
  const auto [x, y] = random_.normals(sample, 2 * draw);
  return {x, y, random_.normals(sample, 2 * draw + 1)[0]};
}

Eigen::Matrix3d Imu::make_response(double scale_error, double misalignment,
                                   std::uint32_t draw) const {
  const Eigen::Vector3d above = misalignment * normals(0, draw + 1);
  const Eigen::Vector3d below = misalignment * normals(0, draw + 2);
  Eigen::Matrix3d response;
  response << 1.0, above[0], above[1], below[0], 1.0, above[2], below[1], below[2], 1.0;
  response.diagonal() += scale_error * normals(0, draw);
  return response;
}

void Imu::vibrate(const flight::Motion& motion, ImuSample& sample) const {
  const Eigen::Vector3d up(0.0, 0.0, flight::kGravity);
  // The force of an unbalanced propeller grows with the square of its speed, as its thrust does.
  const double thrust = (motion.acceleration_world + up).norm() / flight::kGravity;
  for (std::size_t i = 0; i < config_.vibration.size(); ++i) {
    const VibrationTone& tone = config_.vibration[i];
    const double cycles = tone.frequency_hz * to_seconds(sample.stamp);
    const auto wave = [&](std::uint32_t axis) {
      return std::sin(2.0 * std::numbers::pi *
                      (cycles + random_.uniform(i, 2 * kVibration + axis)));
    };
    const double gain = tone.grows_with_thrust ? thrust : 1.0;
    sample.accel +=
        gain * tone.accel_amplitude.cwiseProduct(Eigen::Vector3d(wave(0), wave(1), wave(2)));
    sample.gyro +=
        gain * tone.gyro_amplitude.cwiseProduct(Eigen::Vector3d(wave(3), wave(4), wave(5)));
  }
}

void Imu::walk_biases() {
  // Sigma of one step of a random walk: density * sqrt(1 / rate).
  const double root_rate = std::sqrt(config_.rate_hz);
  const bool first = next_ == 0;
  gyro_bias_ += (first ? config_.gyro_turn_on_bias : config_.gyro_bias_walk / root_rate) *
                normals(next_, kGyroBias);
  accel_bias_ += (first ? config_.accel_turn_on_bias : config_.accel_bias_walk / root_rate) *
                 normals(next_, kAccelBias);
}

ImuSample Imu::measure(const flight::Flight& flight) {
  const flight::Motion motion = flight.at(next_stamp());
  ImuSample sample = perfect_imu(motion, body_from_imu_);
  sample.stamp = next_stamp();
  if (noise_) {
    vibrate(motion, sample);
    walk_biases();
    const double root_rate = std::sqrt(config_.rate_hz);  // a sample's sigma: density * root_rate
    const Eigen::Vector3d gyro =
        gyro_response_ * sample.gyro +
        (gyro_bias_ + config_.gyro_noise_density * root_rate * normals(next_, kGyroNoise));
    const Eigen::Vector3d accel =
        accel_response_ * sample.accel +
        (accel_bias_ + config_.accel_noise_density * root_rate * normals(next_, kAccelNoise));
    sample.gyro = digitized(gyro, config_.gyro_range, config_.gyro_resolution);
    sample.accel = digitized(accel, config_.accel_range, config_.accel_resolution);
  }
  ++next_;
  return sample;
}

}  // namespace lidarena::sensor
