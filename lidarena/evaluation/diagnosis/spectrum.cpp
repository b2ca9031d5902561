// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/diagnosis/spectrum.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <numbers>

#include <unsupported/Eigen/FFT>

namespace lidarena::evaluation {
namespace {

constexpr double kWindow_s = 2.5;

double median_of(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::vector<double> hann(std::size_t size) {
  std::vector<double> window(size);
  for (std::size_t i = 0; i < size; ++i)
    window[i] = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * static_cast<double>(i) /
                                     static_cast<double>(size));
  return window;
}

}  // namespace

Spectrum spectrum_of(std::span<const ImuSample> samples, Eigen::Vector3d ImuSample::*member) {
  Spectrum spectrum;
  if (samples.size() < 2) return spectrum;
  const double rate_hz = static_cast<double>(samples.size() - 1) /
                         to_seconds(samples.back().stamp - samples.front().stamp);
  const std::size_t size = std::bit_floor(static_cast<std::size_t>(kWindow_s * rate_hz));
  if (size < 16 || samples.size() < 2 * size) return spectrum;
  const std::vector<double> window = hann(size);
  double window_power = 0.0;
  for (const double w : window) window_power += w * w;
  std::vector<double> sum(size / 2, 0.0);
  std::size_t windows = 0;
  Eigen::FFT<double> fft;
  std::vector<double> part(size);
  std::vector<std::complex<double>> bins;
  for (std::size_t begin = 0; begin + size <= samples.size(); begin += size / 2, ++windows) {
    for (int axis = 0; axis < 3; ++axis) {
      double mean = 0.0;
      for (std::size_t i = 0; i < size; ++i) mean += (samples[begin + i].*member)[axis];
      mean /= static_cast<double>(size);
      for (std::size_t i = 0; i < size; ++i)
        part[i] = window[i] * ((samples[begin + i].*member)[axis] - mean);
      fft.fwd(bins, part);
      for (std::size_t k = 1; k <= size / 2; ++k) sum[k - 1] += std::norm(bins[k]);
    }
  }
  const double scale = 2.0 / (rate_hz * window_power * static_cast<double>(windows));
  for (std::size_t k = 1; k <= size / 2; ++k) {
    spectrum.frequency_hz.push_back(static_cast<double>(k) * rate_hz / static_cast<double>(size));
    const double both_sides = k == size / 2 ? 0.5 : 1.0;  // half the rate has one bin
    spectrum.density.push_back(both_sides * scale * sum[k - 1]);
  }
  return spectrum;
}

std::vector<Peak> peaks_of(const Spectrum& spectrum, std::size_t most) {
  constexpr double kHigh = 10.0;            // times the surroundings
  constexpr double kLowest_hz = 5.0;        // below is the motion itself
  constexpr std::ptrdiff_t kHalfWidth = 3;  // bins of a peak: Hann's window widens a line
  std::vector<Peak> peaks;
  const auto count = static_cast<std::ptrdiff_t>(spectrum.density.size());
  if (count < 2) return peaks;
  const double step_hz = spectrum.frequency_hz[1] - spectrum.frequency_hz[0];
  for (std::ptrdiff_t k = 0; k < count; ++k) {
    const auto at = [&](std::ptrdiff_t i) { return spectrum.density[static_cast<std::size_t>(i)]; };
    const double frequency = spectrum.frequency_hz[static_cast<std::size_t>(k)];
    if (frequency < kLowest_hz) continue;
    const std::ptrdiff_t first = std::max<std::ptrdiff_t>(0, k - kHalfWidth);
    const std::ptrdiff_t last = std::min(count - 1, k + kHalfWidth);
    bool is_highest = true;
    for (std::ptrdiff_t i = first; i <= last; ++i) is_highest = is_highest && at(k) >= at(i);
    if (!is_highest) continue;
    const auto from = static_cast<std::ptrdiff_t>(static_cast<double>(k) / std::numbers::sqrt2);
    const auto to = std::min(
        count, static_cast<std::ptrdiff_t>(static_cast<double>(k) * std::numbers::sqrt2) + 2);
    const double floor =
        median_of({spectrum.density.begin() + from, spectrum.density.begin() + to});
    if (at(k) < kHigh * floor) continue;
    double power = 0.0;
    for (std::ptrdiff_t i = first; i <= last; ++i) power += std::max(0.0, at(i) - floor) * step_hz;
    peaks.push_back({frequency, std::sqrt(power)});
  }
  std::ranges::sort(peaks, std::ranges::greater{}, &Peak::rms);
  if (peaks.size() > most) peaks.resize(most);
  return peaks;
}

double rise_to_nyquist(const Spectrum& spectrum) {
  const auto part = [&](double from, double to) {
    const auto size = static_cast<double>(spectrum.density.size());
    return std::vector<double>(spectrum.density.begin() + static_cast<std::ptrdiff_t>(from * size),
                               spectrum.density.begin() + static_cast<std::ptrdiff_t>(to * size));
  };
  if (spectrum.density.size() < 20) return 1.0;
  const std::vector<double> top = part(0.9, 1.0);
  double mean = 0.0;
  for (const double density : top) mean += density / static_cast<double>(top.size());
  const double middle = median_of(part(0.25, 0.75));
  return middle > 0.0 ? mean / middle : 1.0;
}

}  // namespace lidarena::evaluation
