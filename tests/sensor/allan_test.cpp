// SPDX-License-Identifier: BSD-3-Clause
// The Allan deviation of a long recording at rest reproduces the configured densities (IEEE Std
// 952-1997, annex C): white noise N gives N^2 / tau, a bias random walk K gives K^2 tau / 3.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "lidarena/sensor/imu.hpp"
#include "tests/sensor/flights.hpp"

namespace lidarena::sensor {
namespace {

const std::filesystem::path kConfigs = LIDARENA_SOURCE_DIR "/configs/sensors";

/// The three axes of a gyro and of an accelerometer, at rest.
struct Record {
  std::vector<Eigen::Vector3d> gyro, accel;
};

Record record(const ImuConfig& config, int samples) {
  Imu imu(config, Pose::Identity(), "test", 11, true);
  const auto flight = testing::rest(Pose::Identity());
  Record out;
  for (int k = 0; k < samples; ++k) {
    const ImuSample sample = imu.measure(flight);
    out.gyro.push_back(sample.gyro);
    out.accel.push_back(sample.accel);
  }
  return out;
}

/// Allan variance over adjacent clusters of `length` samples, mean of three axes, and its relative
/// sigma. With M clusters per axis, M - 1 differences are averaged. Neighboring differences
/// correlate by -1/2 for white noise and by +1/4 for a random walk, so the variance of the mean
/// square is at most 2 (1 + 2 (1/2)^2) / (M - 1) = 3 / (M - 1) of its square, and a third of that
/// over three axes.
struct Allan {
  double variance;
  double relative_sigma;
};

Allan allan(const std::vector<Eigen::Vector3d>& samples, std::size_t length) {
  std::vector<Eigen::Vector3d> means;
  for (std::size_t begin = 0; begin + length <= samples.size(); begin += length) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = begin; i < begin + length; ++i) sum += samples[i];
    means.push_back(sum / static_cast<double>(length));
  }
  double squares = 0.0;
  for (std::size_t i = 1; i < means.size(); ++i) squares += (means[i] - means[i - 1]).squaredNorm();
  const auto differences = static_cast<double>(means.size() - 1);
  return {squares / (2.0 * 3.0 * differences), 1.0 / std::sqrt(differences)};
}

/// Checks N^2 / tau + K^2 tau / 3 at every octave from 8 samples to a fortieth of the record.
void expect_densities(const std::vector<Eigen::Vector3d>& samples, double rate_hz, double noise,
                      double walk) {
  for (std::size_t length = 8; 40 * length <= samples.size(); length *= 2) {
    const double tau = static_cast<double>(length) / rate_hz;
    const double expected = noise * noise / tau + walk * walk * tau / 3.0;
    const Allan found = allan(samples, length);
    // four sigma, plus 1 / (2 * 8^2) by which a discrete random walk exceeds the continuous one
    EXPECT_NEAR(found.variance / expected, 1.0, 4.0 * found.relative_sigma + 0.008) << tau << " s";
  }
}

/// Slope of the logarithm of the Allan deviation between two cluster lengths.
double slope(const std::vector<Eigen::Vector3d>& samples, std::size_t from, std::size_t to) {
  return 0.5 * std::log(allan(samples, to).variance / allan(samples, from).variance) /
         std::log(static_cast<double>(to) / static_cast<double>(from));
}

TEST(Allan, TheShippedSensorsHaveTheDensitiesOfTheirFiles) {
  for (const char* file : {"livox_mid360.yaml", "ouster_os0_128.yaml"}) {
    const ImuConfig imu = *load_sensor(kConfigs / file).imu;
    const Record run = record(imu, 400'000);
    expect_densities(run.gyro, imu.rate_hz, imu.gyro_noise_density, imu.gyro_bias_walk);
    expect_densities(run.accel, imu.rate_hz, imu.accel_noise_density, imu.accel_bias_walk);
  }
}

TEST(Allan, WhiteNoiseFallsAndABiasWalkRisesWithTheRootOfTheTime) {
  ImuConfig config;
  config.rate_hz = 100.0;
  config.gyro_noise_density = 1e-4;  // crosses the walk at sqrt(3) N / K = 17 s
  config.gyro_bias_walk = 1e-5;
  config.accel_noise_density = 1e-3;  // crosses at 0.017 s: less than two samples
  config.accel_bias_walk = 1e-1;
  const Record run = record(config, 200'000);
  expect_densities(run.gyro, 100.0, 1e-4, 1e-5);
  expect_densities(run.accel, 100.0, 1e-3, 1e-1);
  // The relative sigma of the ratio of two variances is at most the sum of theirs; a slope is half
  // the logarithm of that ratio, divided by the logarithm of the ratio of times.
  const auto error = [](std::size_t a, std::size_t b) {
    const double sigma = std::sqrt(static_cast<double>(a) / 200'000.0) +
                         std::sqrt(static_cast<double>(b) / 200'000.0);
    return 4.0 * 0.5 * sigma / std::log(static_cast<double>(b) / static_cast<double>(a));
  };
  EXPECT_NEAR(slope(run.gyro, 2, 64), -0.5, error(2, 64));
  EXPECT_NEAR(slope(run.accel, 32, 4096), +0.5, error(32, 4096));
}

}  // namespace
}  // namespace lidarena::sensor
