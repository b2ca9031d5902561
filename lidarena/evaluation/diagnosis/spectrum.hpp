// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "lidarena/base/imu_sample.hpp"

namespace lidarena::evaluation {

/// Power spectral density of a vector quantity, the sum over its axes, one-sided: its integral over
/// frequency is the variance.
struct Spectrum {
  static constexpr const char* kTitle = "Spectrum";
  std::vector<double> frequency_hz;  ///< ascending, without 0
  std::vector<double> density;       ///< in the square of the quantity's unit per Hz
  bool empty() const { return frequency_hz.empty(); }

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("frequency_hz", self.frequency_hz, "Hz", "");
    v("density", self.density, "", "square of the unit per Hz, summed over the axes");
  }
};

/// By Welch's method (P. Welch, "The use of fast Fourier transform for the estimation of power
/// spectra", 1967): Hann windows of about 2.5 s that overlap by half, each without its mean. Empty
/// if the samples last less than two windows.
Spectrum spectrum_of(std::span<const ImuSample> samples, Eigen::Vector3d ImuSample::*member);

/// A narrow rise of a spectrum.
struct Peak {
  double frequency_hz = 0.0;
  double rms = 0.0;  ///< of what rises above the median of its surroundings
};

/// Peaks of at least ten times the median of the surroundings (an octave), strongest first, of at
/// most `most`.
std::vector<Peak> peaks_of(const Spectrum& spectrum, std::size_t most = 3);

/// Mean density of the highest tenth of the band over the median of the band from a quarter to
/// three quarters: 1 for white noise, more if power rises towards half the rate.
double rise_to_nyquist(const Spectrum& spectrum);

}  // namespace lidarena::evaluation
