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

/// The same IMU with at least the noise of a Mid-360's.
ImuInfo at_least_nominal(ImuInfo imu);

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

/// The white noise of an IMU that the corrections of its predictions show, as a running mean over
/// two seconds (covariance matching in the steady state: A. Sage, G. Husa, "Adaptive filtering with
/// unknown prior statistics", 1969). It begins at zero, since the first corrections are those of an
/// uncertain start. Corrections are summed over `span` (s) first. Over a longer
/// one, less of the noise of the updates themselves is taken for the IMU's.
class CorrectionNoise {
 public:
  explicit CorrectionNoise(double span_s = 0.0) : span_s_(span_s) {}
  /// `correction`: what an update adds to a quantity that the IMU was integrated to over `seconds`.
  void add(const Eigen::Vector3d& correction, double seconds);
  /// Of each axis, in that unit times 1/sqrt(s): rad/s/sqrt(Hz) of rotations.
  double density() const;

 private:
  double span_s_;
  Eigen::Vector3d sum_ = Eigen::Vector3d::Zero();
  double sum_s_ = 0.0;  ///< over which `sum_` runs
  double power_ = 0.0;  ///< square of the density, mean of the axes
};

}  // namespace lidarena::estimation
