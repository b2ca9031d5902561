// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/base/rig.hpp"

namespace lidarena::estimation {

/// Noise of an IMU: continuous densities, as on data sheets.
struct ImuNoise {
  double gyro_density = 0.0;     ///< rad/s/sqrt(Hz)
  double accel_density = 0.0;    ///< m/s^2/sqrt(Hz)
  double gyro_bias_walk = 0.0;   ///< rad/s^2/sqrt(Hz)
  double accel_bias_walk = 0.0;  ///< m/s^3/sqrt(Hz)
};

/// While no samples arrive: large enough to cover what a vehicle may do meanwhile.
inline constexpr ImuNoise kCoastingNoise{0.5, 5.0, 1e-3, 1e-2};

/// Faster than any vehicle that carries these sensors, m/s: an estimate beyond it has diverged.
inline constexpr double kMaxPlausibleSpeed = 100.0;

/// The noise that a rig names, times `factor`; what it leaves out (zero) is a Mid-360's.
ImuNoise noise_of(const ImuInfo& imu, double factor);

}  // namespace lidarena::estimation
