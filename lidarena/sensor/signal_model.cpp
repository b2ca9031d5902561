// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/signal_model.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lidarena/base/error.hpp"

namespace lidarena::sensor {

void check_returns(const NoiseConfig& noise, const ReturnConfig& returns,
                   const std::string& place) {
  const SignalConfig& signal = noise.signal;
  const bool rated = signal.range_at_10_m > 0.0 && signal.range_at_80_m > 0.0;
  if (rated && signal.range_at_80_m <= signal.range_at_10_m) {
    throw InputError(place, "noise.signal.range_at_80_m is not above range_at_10_m");
  }
  // For a larger ratio the signal that fits both ranges would rise with range before the far one.
  if (rated && signal.range_at_80_m > 6.0 * signal.range_at_10_m) {
    throw InputError(place, "noise.signal.range_at_80_m is more than six times range_at_10_m");
  }
  if (!rated && (noise.dropouts || noise.weak_signal_noise)) {
    throw InputError(place, "noise.dropouts and noise.weak_signal_noise need the rated ranges",
                     "set noise.signal.range_at_10_m and range_at_80_m");
  }
  if (signal.false_alarms >= signal.detection) {
    throw InputError(place, "noise.signal.false_alarms is not below detection");
  }
  if (noise.near_range_noise_m > 0.0 && noise.near_until_m <= noise.near_range_m) {
    throw InputError(place, "noise.near_until_m is not above near_range_m");
  }
  const BeamConfig& beam = noise.beam;
  if (beam.sub_rays > 1 && beam.width_deg == 0.0 && beam.height_deg == 0.0) {
    throw InputError(place, "noise.beam.sub_rays needs a beam with a width",
                     "set noise.beam.width_deg and height_deg");
  }
  const bool has_strays = has_particles(noise.air) || noise.blooming.share > 0.0;
  if (!rated && has_strays) {
    throw InputError(place, "noise.air and noise.blooming need the rated ranges",
                     "set noise.signal.range_at_10_m and range_at_80_m");
  }
  if (noise.air.rain_mm_h > 0.0 && (beam.width_deg == 0.0 || beam.height_deg == 0.0)) {
    throw InputError(place, "noise.air.rain_mm_h needs a beam with a width",
                     "set noise.beam.width_deg and height_deg");
  }
  const bool is_single = beam.sub_rays == 1 && noise.bounces == 0 && !has_strays;
  if (returns.count > 1 && is_single) {
    throw InputError(place, "returns.count above 1 needs a beam of several sub-rays",
                     "set noise.beam.sub_rays, width_deg and height_deg");
  }
}

double normal_cdf(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

double normal_quantile(double p) {
  double low = -40.0, high = 40.0;  // beyond this, p is not representable as a double
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (normal_cdf(middle) < p ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

SignalModel::SignalModel(const SignalConfig& config)
    : threshold_(-normal_quantile(config.false_alarms)) {
  rated_ = threshold_ + normal_quantile(config.detection);
  if (config.range_at_10_m > 0.0 && config.range_at_80_m > 0.0) {
    reference_m_ = config.range_at_10_m;
    const double ratio = config.range_at_10_m / config.range_at_80_m;
    extinction_ =
        std::log(8.0 * ratio * ratio) / (2.0 * (config.range_at_80_m - config.range_at_10_m));
  }
}

double SignalModel::signal(double energy, double range) const {
  const double signal = 10.0 * reference_m_ * reference_m_ * energy / (range * range);
  return extinction_ == 0.0 ? signal
                            : signal * std::exp(-2.0 * extinction_ * (range - reference_m_));
}

double SignalModel::detection_probability(double signal) const {
  constexpr double kCertain = 8.3;  // sigmas; above this the distribution rounds to 1
  const double margin = signal * rated_ - threshold_;
  return margin > kCertain ? 1.0 : normal_cdf(margin);
}

double range_sigma(double range_noise_m, const NoiseConfig& noise, double range, double signal) {
  double sigma = range_noise_m;
  if (noise.near_range_noise_m > 0.0 && range < noise.near_until_m) {
    const double fraction =
        (noise.near_until_m - range) / (noise.near_until_m - noise.near_range_m);
    sigma += (noise.near_range_noise_m - range_noise_m) * std::min(fraction, 1.0);
  }
  return noise.weak_signal_noise && signal < 1.0 ? sigma / std::sqrt(signal) : sigma;
}

}  // namespace lidarena::sensor
