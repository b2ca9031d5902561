// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>

#include "lidarena/base/imu_sample.hpp"
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

/// The white noise that the samples of an IMU show, vibration included, as a running mean over
/// about a second: their fourth differences, in which the motion of a body hardly appears (a motion
/// of 2 Hz, sampled at 200 Hz, to 2e-6). Of white noise of variance v they have the variance 70 v,
/// the sum of the squared binomial coefficients.
class MeasuredNoise {
 public:
  void add(const ImuSample& sample);
  /// The densities that are stated, or those measured where they are larger.
  ImuNoise at_least(ImuNoise stated) const;

 private:
  std::deque<ImuSample> last_;  ///< without a gap, at most five
  double measured_s_ = 0.0;     ///< how long the mean has run
  double gyro_power_ = 0.0;     ///< square of the density, mean of the axes
  double accel_power_ = 0.0;    ///< the same of the accelerometer
};

}  // namespace lidarena::estimation
