// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/imu.hpp"

#include <algorithm>
#include <cmath>

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
  kVibration = kAccelResponse + 3  // six phases, see vibration.cpp
};
/// The same for the stream of the response's further errors.
enum ResponseDraw : std::uint32_t { kSensitivity, kGyroCurve = 3, kAccelCurve };

constexpr double kLeastStepHz = 4000.0;   // rate of the values that the low-pass takes, at least
constexpr double kStepsPerCutoff = 20.0;  // and as a multiple of its cutoff

ImuConfig without_errors(const ImuConfig& config) {
  ImuConfig bare;
  bare.rate_hz = config.rate_hz;
  bare.gravity = config.gravity;
  return bare;
}

SensorClock imu_clock(const ImuConfig& config, const ClockConfig& lidar, const std::string& name,
                      std::uint64_t seed) {
  return {lidar.imu_shares ? lidar.offset_s : 0.0,
          lidar.imu_shares ? lidar.drift : 0.0,
          config.stamp_jitter_s,
          from_seconds(1.0 / config.rate_hz),
          name,
          seed};
}

Eigen::Vector3d normals_of(const CounterRandom& random, std::uint64_t index, std::uint32_t draw) {
  const auto [x, y] = random.normals(index, 2 * draw);
  return {x, y, random.normals(index, 2 * draw + 1)[0]};
}

/// Output of the analog-to-digital converter for `value`.
Eigen::Vector3d digitized(const Eigen::Vector3d& value, double range, double resolution) {
  Eigen::Vector3d read = value;
  if (resolution > 0.0) read = (value / resolution).array().round() * resolution;
  if (range > 0.0) read = read.cwiseMax(-range).cwiseMin(range);
  return read;
}

}  // namespace

ImuConfig with_error_factor(ImuConfig imu) {
  for (double* error : {&imu.gyro_noise_density, &imu.accel_noise_density, &imu.gyro_bias_walk,
                        &imu.accel_bias_walk, &imu.gyro_turn_on_bias, &imu.accel_turn_on_bias,
                        &imu.gyro_scale_error, &imu.accel_scale_error, &imu.gyro_misalignment,
                        &imu.accel_misalignment, &imu.gyro_g_sensitivity, &imu.gyro_nonlinearity,
                        &imu.accel_nonlinearity})
    *error *= imu.error_factor;
  imu.error_factor = 1.0;
  return imu;
}

ImuSample perfect_imu(const flight::Motion& motion, const Pose& body_from_imu, double gravity) {
  const Eigen::Vector3d gravity_world(0.0, 0.0, -gravity);
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
         std::uint64_t seed, bool noise, const ClockConfig& clock)
    : config_(noise ? with_error_factor(config) : without_errors(config)),
      body_from_imu_(body_from_imu),
      noise_(noise),
      random_(seed, stream_of((id + "/imu").c_str())),
      loss_(seed, stream_of((id + "/imu/lost").c_str())),
      response_(seed, stream_of((id + "/imu/response").c_str())),
      vibration_(config_, id + "/imu", seed),
      gyro_response_(
          make_response(config_.gyro_scale_error, config_.gyro_misalignment, kGyroResponse)),
      accel_response_(
          make_response(config_.accel_scale_error, config_.accel_misalignment, kAccelResponse)),
      g_sensitivity_(make_g_sensitivity()) {
  if (noise_) clock_ = imu_clock(config_, clock, id + "/imu", seed);
  if (config_.bandwidth_hz > 0.0) {
    const double rate = std::max(kLeastStepHz, kStepsPerCutoff * config_.bandwidth_hz);
    steps_ = static_cast<std::uint64_t>(std::ceil(rate / config_.rate_hz));
    low_pass_.emplace(config_.bandwidth_hz, static_cast<double>(steps_) * config_.rate_hz);
  }
  const auto curve = [&](double share, double range, std::uint32_t draw) -> Eigen::Vector3d {
    if (share == 0.0 || range == 0.0) return Eigen::Vector3d::Zero();
    return share / range * normals_of(response_, 0, draw);
  };
  gyro_curve_ = curve(config_.gyro_nonlinearity, config_.gyro_range, kGyroCurve);
  accel_curve_ = curve(config_.accel_nonlinearity, config_.accel_range, kAccelCurve);
}

Time Imu::true_time(std::uint64_t sample) const {
  return from_seconds(static_cast<double>(sample) / config_.rate_hz);
}

bool Imu::is_lost(std::uint64_t sample) const {
  return config_.lost_share > 0.0 && loss_.uniform(sample) < config_.lost_share;
}

std::uint64_t Imu::delivered_from(std::uint64_t sample) const {
  while (is_lost(sample)) ++sample;
  return sample;
}

Time Imu::first_stamp_from(Time t) const {
  const double place = to_seconds(clock_.true_time(t)) * config_.rate_hz;
  auto sample = static_cast<std::uint64_t>(std::max(0.0, place));
  // May be off by one due to rounding or the jitter, which is less than half a period.
  while (sample > 0 && stamp(sample) >= t) --sample;
  sample = delivered_from(sample);
  while (stamp(sample) < t) sample = delivered_from(sample + 1);
  return stamp(sample);
}

Eigen::Vector3d Imu::normals(std::uint64_t sample, std::uint32_t draw) const {
  return normals_of(random_, sample, draw);
}

Eigen::Matrix3d Imu::make_g_sensitivity() const {
  Eigen::Matrix3d sensitivity;
  for (std::uint32_t column = 0; column < 3; ++column)
    sensitivity.col(column) = normals_of(response_, 0, kSensitivity + column);
  return config_.gyro_g_sensitivity * sensitivity;
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

ImuSample Imu::felt(const flight::Flight& flight, Time t, const Vibration::Gains& gains) const {
  ImuSample sample = perfect_imu(flight.at(t), body_from_imu_, config_.gravity);
  if (!vibration_.empty()) vibration_.add(t, gains, sample.accel, sample.gyro);
  return sample;
}

ImuSample Imu::sampled(const flight::Flight& flight) {
  const Time t = true_time(next_) - from_seconds(config_.delay_s);
  const bool vibrates = !vibration_.empty();
  const auto gains =
      vibrates ? vibration_.gains(relative_thrust(flight.at(t))) : Vibration::Gains{};
  if (!low_pass_) return felt(flight, t, gains);
  const double period = 1.0 / (config_.rate_hz * static_cast<double>(steps_));
  ImuSample sample;
  for (std::uint64_t left = steps_; left-- > 0;) {
    sample = felt(flight, t - from_seconds(static_cast<double>(left) * period), gains);
    LowPass::Vector6 value;
    value << sample.accel, sample.gyro;
    value = low_pass_->filtered(value);
    sample.accel = value.head<3>();
    sample.gyro = value.tail<3>();
  }
  return sample;
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

/// Non-linearity and g-sensitivity are errors of the part's true input, as scale is.
void Imu::distort(ImuSample& sample) const {
  const double root_rate = std::sqrt(config_.rate_hz);  // a sample's sigma: density * root_rate
  Eigen::Vector3d gyro =
      gyro_response_ * sample.gyro +
      (gyro_bias_ + config_.gyro_noise_density * root_rate * normals(next_, kGyroNoise));
  Eigen::Vector3d accel =
      accel_response_ * sample.accel +
      (accel_bias_ + config_.accel_noise_density * root_rate * normals(next_, kAccelNoise));
  if (config_.gyro_g_sensitivity > 0.0) gyro += g_sensitivity_ * sample.accel;
  if (config_.gyro_nonlinearity > 0.0) gyro += gyro_curve_.cwiseProduct(sample.gyro.cwiseAbs2());
  if (config_.accel_nonlinearity > 0.0)
    accel += accel_curve_.cwiseProduct(sample.accel.cwiseAbs2());
  sample.gyro = digitized(gyro, config_.gyro_range, config_.gyro_resolution);
  sample.accel = digitized(accel, config_.accel_range, config_.accel_resolution);
}

ImuSample Imu::measure_next(const flight::Flight& flight) {
  ImuSample sample = sampled(flight);
  sample.stamp = stamp(next_);
  if (noise_) {
    walk_biases();
    distort(sample);
  }
  ++next_;
  return sample;
}

ImuSample Imu::measure(const flight::Flight& flight) {
  const std::uint64_t delivered = delivered_from(next_);
  while (next_ < delivered) measure_next(flight);
  return measure_next(flight);
}

}  // namespace lidarena::sensor
