// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/imu_noise.hpp"

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

}  // namespace lidarena::estimation
