// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/imu_noise.hpp"

#include <algorithm>
#include <cmath>

namespace lidarena::estimation {
namespace {

// Data sheet of the ICM-40609-D inside a Livox Mid-360; the walks are assumed.
constexpr ImuNoise kNominalNoise{7.85e-5, 9.81e-4, 1e-5, 1e-4};

}  // namespace

ImuNoise noise_of(const ImuInfo& imu, double factor) {
  const auto density = [factor](double given, double nominal) {
    return factor * (given > 0.0 ? given : nominal);
  };
  return {density(imu.gyro_noise_density, kNominalNoise.gyro_density),
          density(imu.accel_noise_density, kNominalNoise.accel_density),
          density(imu.gyro_bias_walk, kNominalNoise.gyro_bias_walk),
          density(imu.accel_bias_walk, kNominalNoise.accel_bias_walk)};
}

ImuInfo at_least_nominal(ImuInfo imu) {
  imu.gyro_noise_density = std::max(imu.gyro_noise_density, kNominalNoise.gyro_density);
  imu.accel_noise_density = std::max(imu.accel_noise_density, kNominalNoise.accel_density);
  imu.gyro_bias_walk = std::max(imu.gyro_bias_walk, kNominalNoise.gyro_bias_walk);
  imu.accel_bias_walk = std::max(imu.accel_bias_walk, kNominalNoise.accel_bias_walk);
  return imu;
}

void MeasuredNoise::add(const ImuSample& sample) {
  constexpr std::size_t kSamples = 5;
  constexpr double kMean_s = 1.0;
  constexpr double kVariance = 70.0;  // 1 + 16 + 36 + 16 + 1
  if (last_.size() >= 2) {
    const Time step = last_[1].stamp - last_[0].stamp, now = sample.stamp - last_.back().stamp;
    if (2 * now > 3 * step || 2 * step > 3 * now) last_.clear();  // a gap
  }
  last_.push_back(sample);
  if (last_.size() < kSamples) return;
  const auto power = [&](Eigen::Vector3d ImuSample::*member) {
    const Eigen::Vector3d difference = last_[0].*member - 4.0 * last_[1].*member +
                                       6.0 * last_[2].*member - 4.0 * last_[3].*member +
                                       last_[4].*member;
    return difference.squaredNorm() / (3.0 * kVariance);
  };
  const double dt = to_seconds(last_[4].stamp - last_[0].stamp) / 4.0;
  measured_s_ = std::min(measured_s_ + dt, kMean_s);
  const double share = dt / measured_s_;
  gyro_power_ += share * (dt * power(&ImuSample::gyro) - gyro_power_);
  accel_power_ += share * (dt * power(&ImuSample::accel) - accel_power_);
  last_.pop_front();
}

ImuNoise MeasuredNoise::at_least(ImuNoise stated) const {
  stated.gyro_density = std::max(stated.gyro_density, std::sqrt(gyro_power_));
  stated.accel_density = std::max(stated.accel_density, std::sqrt(accel_power_));
  return stated;
}

void CorrectionNoise::add(const Eigen::Vector3d& correction, double seconds) {
  constexpr double kMean_s = 2.0;
  sum_ += correction;
  sum_s_ += seconds;
  if (sum_s_ < span_s_) return;
  const double share = std::min(1.0, sum_s_ / kMean_s);
  power_ += share * (sum_.squaredNorm() / (3.0 * sum_s_) - power_);
  sum_.setZero();
  sum_s_ = 0.0;
}

double CorrectionNoise::density() const { return std::sqrt(power_); }

}  // namespace lidarena::estimation
