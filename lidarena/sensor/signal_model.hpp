// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/sensor/return_config.hpp"

namespace lidarena::sensor {

/// Model of the received signal and of its detection.
///
/// Signal: energy / 0.1 * (r10 / r)^2 * exp(-2 a (r - r10)), the lidar equation with extinction a,
/// where energy is the returned light relative to that of a white diffuse surface at normal
/// incidence (see backscatter()) and r10 = range_at_10_m. It is 1 for a 10 % target at its rated
/// range, and
///   a = ln(8 (r10 / r80)^2) / (2 (r80 - r10))
/// makes it 1 for an 80 % target at its rated range. (a covers all effects that depend on range; it
/// is negative if the data sheet's far range exceeds what the square law gives.)
///
/// Receiver: the signal plus unit Gaussian noise must exceed a threshold, so
///   P(detection) = Phi(signal * rated - threshold),  threshold = -Phi^-1(false alarms),
///   rated = threshold + Phi^-1(detection at the rated range).
class SignalModel {
 public:
  /// Without rated ranges: no extinction, and the signal of a 10 % target is 1 at 1 m.
  explicit SignalModel(const SignalConfig& config);

  double signal(double energy, double range) const;
  double detection_probability(double signal) const;
  double extinction() const { return extinction_; }  ///< 1/m

 private:
  double reference_m_ = 1.0;
  double extinction_ = 0.0;
  double threshold_;
  double rated_;
};

/// Sigma of the range noise, m: `near_range_noise_m` up to near_range_m, falling linearly to
/// `range_noise_m` at near_until_m; where weak_signal_noise is on and the signal is below 1, times
/// 1 / sqrt(signal).
double range_sigma(double range_noise_m, const NoiseConfig& noise, double range, double signal);

/// Cumulative distribution function of the standard normal, and its inverse (0 < p < 1; accurate to
/// 1e-12).
double normal_cdf(double x);
double normal_quantile(double p);

}  // namespace lidarena::sensor
