// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/imu.hpp"

#include <algorithm>
#include <cmath>

namespace lidarena {
namespace {

enum Draw : std::uint32_t { kGyroNoise, kAccelNoise, kGyroBias, kAccelBias };

}  // namespace

ImuSample perfect_imu(const Motion& motion, const Pose& body_from_imu) {
  const Eigen::Vector3d gravity_world(0.0, 0.0, -kGravity);
  const Eigen::Vector3d& rate = motion.angular_rate_body;
  const Eigen::Vector3d arm = body_from_imu.translation();
  const Eigen::Vector3d from_turning =
      motion.angular_acceleration_body.cross(arm) + rate.cross(rate.cross(arm));
  const Eigen::Vector3d force_body =
      motion.world_from_body.linear().transpose() * (motion.acceleration_world - gravity_world) +
      from_turning;
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
      random_(seed, stream_of((id + "/imu").c_str())) {}

Time Imu::stamp(std::uint64_t sample) const {
  return from_seconds(static_cast<double>(sample) / config_.rate_hz);
}

Time Imu::first_stamp_from(Time t) const {
  auto sample = static_cast<std::uint64_t>(std::max(0.0, to_seconds(t) * config_.rate_hz));
  while (sample > 0 && stamp(sample) >= t) --sample;  // rounding may have put it one off
  while (stamp(sample) < t) ++sample;
  return stamp(sample);
}

Eigen::Vector3d Imu::normals(std::uint32_t draw) const {
  const auto [x, y] = random_.normals(next_, 2 * draw);
  return {x, y, random_.normals(next_, 2 * draw + 1)[0]};
}

ImuSample Imu::measure(const Flight& flight) {
  ImuSample sample = perfect_imu(flight.at(next_stamp()), body_from_imu_);
  sample.stamp = next_stamp();
  if (noise_) {
    // A density becomes a sample's sigma by sqrt(rate), a walk becomes a step's by sqrt(1 / rate).
    const double root_rate = std::sqrt(config_.rate_hz);
    const bool first = next_ == 0;
    gyro_bias_ += (first ? config_.gyro_turn_on_bias : config_.gyro_bias_walk / root_rate) *
                  normals(kGyroBias);
    accel_bias_ += (first ? config_.accel_turn_on_bias : config_.accel_bias_walk / root_rate) *
                   normals(kAccelBias);
    sample.gyro += gyro_bias_ + config_.gyro_noise_density * root_rate * normals(kGyroNoise);
    sample.accel += accel_bias_ + config_.accel_noise_density * root_rate * normals(kAccelNoise);
  }
  ++next_;
  return sample;
}

}  // namespace lidarena
