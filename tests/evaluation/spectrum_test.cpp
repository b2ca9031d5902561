// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/diagnosis/spectrum.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace lidarena::evaluation {
namespace {

constexpr double kRate_hz = 200.0;

/// Accelerations on the x axis by time.
template <class Signal>
std::vector<ImuSample> sampled(double seconds, Signal signal) {
  std::vector<ImuSample> samples;
  for (int i = 0; i < static_cast<int>(seconds * kRate_hz); ++i) {
    ImuSample sample;
    sample.stamp = from_seconds(i / kRate_hz);
    sample.accel.x() = signal(i / kRate_hz);
    samples.push_back(sample);
  }
  return samples;
}

double variance_of(const Spectrum& spectrum) {
  double sum = 0.0;
  for (const double density : spectrum.density) sum += density * spectrum.frequency_hz.front();
  return sum;
}

TEST(Spectrum, OfWhiteNoiseIsFlatAndItsIntegralIsTheVariance) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0.0, 0.5);
  const Spectrum spectrum =
      spectrum_of(sampled(200.0, [&](double) { return noise(random); }), &ImuSample::accel);
  EXPECT_NEAR(spectrum.frequency_hz.back(), 100.0, 0.1);
  EXPECT_NEAR(variance_of(spectrum), 0.25, 0.01);
  EXPECT_NEAR(rise_to_nyquist(spectrum), 1.0, 0.1);
  EXPECT_TRUE(peaks_of(spectrum).empty());
}

TEST(Spectrum, ALineIsFoundAtItsFrequencyWithItsRms) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0.0, 0.1);
  const auto tones = [&](double t) {
    return noise(random) + 2.0 * std::sin(2.0 * std::numbers::pi * 41.7 * t) +
           0.6 * std::sin(2.0 * std::numbers::pi * 83.0 * t + 1.0);
  };
  const auto peaks = peaks_of(spectrum_of(sampled(60.0, tones), &ImuSample::accel));
  ASSERT_EQ(peaks.size(), 2U);
  EXPECT_NEAR(peaks[0].frequency_hz, 41.7, 0.4);
  EXPECT_NEAR(peaks[0].rms, 2.0 / std::numbers::sqrt2, 0.05);
  EXPECT_NEAR(peaks[1].frequency_hz, 83.0, 0.4);
  EXPECT_NEAR(peaks[1].rms, 0.6 / std::numbers::sqrt2, 0.03);
}

TEST(Spectrum, ASteadyValueAndAShortRecordingHaveNone) {
  const Spectrum still = spectrum_of(sampled(20.0, [](double) { return 9.81; }), &ImuSample::accel);
  EXPECT_NEAR(variance_of(still), 0.0, 1e-12) << "a mean is no vibration";
  EXPECT_TRUE(spectrum_of(sampled(2.0, [](double) { return 1.0; }), &ImuSample::accel).empty());
}

TEST(Spectrum, PowerThatGrowsWithFrequencyRises) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0.0, 0.5);
  double before = 0.0;
  const auto differences = [&](double) {
    const double now = noise(random), difference = now - before;
    before = now;
    return difference;
  };
  // Differences of white noise have the density 2 - 2 cos(2 pi f / rate) times that of the noise:
  // mean from 0.9 of half the rate up: 3.97; median from a quarter to three quarters: 2.
  EXPECT_NEAR(rise_to_nyquist(spectrum_of(sampled(300.0, differences), &ImuSample::accel)),
              3.97 / 2.0, 0.15);
}

}  // namespace
}  // namespace lidarena::evaluation
