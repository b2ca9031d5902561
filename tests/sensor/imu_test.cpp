// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/imu.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <filesystem>
#include <numbers>
#include <vector>

#include "tests/sensor/flights.hpp"

namespace lidarena::sensor {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

Imu perfect(double rate_hz, const Pose& body_from_imu) {
  ImuConfig config;
  config.rate_hz = rate_hz;
  return Imu(config, body_from_imu, "test", 1, false);
}

TEST(Imu, AtRestFeelsGravityUpwardsInItsOwnFrame) {
  const Pose level = Pose::Identity();
  ImuSample sample = perfect(200, level).measure(testing::rest(level));
  EXPECT_LT((sample.accel - Vector3d(0, 0, flight::kGravity)).norm(), 1e-14);
  EXPECT_TRUE(sample.gyro.isZero());

  // Lying on its left side, up is -y of the body; for an IMU rotated by 180 deg about x it is +y.
  const Pose on_side = testing::tilted_pose({1, 2, 3}, testing::radians(-90), 0, 0.4);
  sample = perfect(200, level).measure(testing::rest(on_side));
  EXPECT_LT((sample.accel - Vector3d(0, -flight::kGravity, 0)).norm(), 1e-12);
  const Pose flipped = testing::tilted_pose({0.1, 0.2, 0.3}, testing::radians(180), 0, 0);
  sample = perfect(200, flipped).measure(testing::rest(on_side));
  EXPECT_LT((sample.accel - Vector3d(0, flight::kGravity, 0)).norm(), 1e-12);
}

TEST(Imu, OnALeverArmFeelsTheCentripetalForceOfASteadySpin) {
  const double rate = 3.0;
  const testing::UniformFlight spin(Pose::Identity(), Vector3d::Zero(), {0, 0, rate}, 2.0);
  const Pose on_arm = make_pose(Quaterniond::Identity(), {0.5, 0, 0.2});
  Imu imu = perfect(100, on_arm);
  for (int k = 0; k < 50; ++k) {
    const ImuSample sample = imu.measure(spin);
    EXPECT_LT((sample.accel - Vector3d(-rate * rate * 0.5, 0, flight::kGravity)).norm(), 1e-12);
    EXPECT_LT((sample.gyro - Vector3d(0, 0, rate)).norm(), 1e-14);
  }
}

ImuConfig noisy() {
  ImuConfig config;
  config.rate_hz = 200.0;
  config.gyro_noise_density = 7.85e-5;
  config.accel_noise_density = 9.81e-4;
  return config;
}

TEST(Imu, WhiteNoiseHasTheDensityTimesTheRootOfTheRate) {
  Imu imu(noisy(), Pose::Identity(), "test", 7, true);
  const auto flight = testing::rest(Pose::Identity());
  const int count = 40'000;
  Vector3d gyro_squares = Vector3d::Zero();
  Vector3d accel_squares = Vector3d::Zero();
  for (int k = 0; k < count; ++k) {
    const ImuSample sample = imu.measure(flight);
    gyro_squares += sample.gyro.cwiseAbs2();
    accel_squares += (sample.accel - Vector3d(0, 0, flight::kGravity)).cwiseAbs2();
  }
  const double gyro_sigma = 7.85e-5 * std::sqrt(200.0);
  const double accel_sigma = 9.81e-4 * std::sqrt(200.0);
  const double error = 4.0 / std::sqrt(2.0 * count);  // four sigma of a standard deviation
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(std::sqrt(gyro_squares[axis] / count) / gyro_sigma, 1.0, error);
    EXPECT_NEAR(std::sqrt(accel_squares[axis] / count) / accel_sigma, 1.0, error);
  }
}

TEST(Imu, BiasBeginsAtTheTurnOnBiasAndSpreadsAsARandomWalk) {
  ImuConfig config;
  config.rate_hz = 100.0;
  config.gyro_turn_on_bias = 0.01;
  config.accel_bias_walk = 0.002;
  const auto flight = testing::rest(Pose::Identity());
  const int runs = 400;
  const int samples = 500;
  double first_squares = 0.0;
  double walk_squares = 0.0;
  for (int run = 0; run < runs; ++run) {
    Imu imu(config, Pose::Identity(), "test", static_cast<std::uint64_t>(run), true);
    const ImuSample first = imu.measure(flight);
    ImuSample last = first;
    for (int k = 0; k < samples; ++k) last = imu.measure(flight);
    first_squares += first.gyro.squaredNorm();
    EXPECT_EQ(first.gyro, last.gyro);  // the gyro has no bias but the turn-on bias
    walk_squares += (last.accel - first.accel).squaredNorm();
  }
  const double seconds = samples / 100.0;
  const double error = 4.0 / std::sqrt(2.0 * 3 * runs);
  EXPECT_NEAR(std::sqrt(first_squares / (3 * runs)) / 0.01, 1.0, error);
  EXPECT_NEAR(std::sqrt(walk_squares / (3 * runs)) / (0.002 * std::sqrt(seconds)), 1.0, error);
}

TEST(Imu, TheSameSeedGivesTheSameSamplesAndAnotherSeedOrNameOthers) {
  const testing::SwingingFlight flight(1.0);
  Imu a(noisy(), Pose::Identity(), "one", 3, true);
  Imu b(noisy(), Pose::Identity(), "one", 3, true);
  Imu other_seed(noisy(), Pose::Identity(), "one", 4, true);
  Imu other_name(noisy(), Pose::Identity(), "two", 3, true);
  for (int k = 0; k < 100; ++k) {
    const ImuSample sample = a.measure(flight);
    const ImuSample other = b.measure(flight);
    EXPECT_EQ(sample.gyro, other.gyro);
    EXPECT_EQ(sample.accel, other.accel);
    EXPECT_EQ(sample.stamp, std::chrono::milliseconds(5 * k));
    EXPECT_NE(sample.gyro, other_seed.measure(flight).gyro);
    EXPECT_NE(sample.gyro, other_name.measure(flight).gyro);
  }
}

TEST(Imu, KnowsItsFirstSampleAtOrAfterAnInstantWhateverItsRate) {
  for (const double rate : {100.0, 133.0, 200.0, 640.0}) {
    const Imu imu = perfect(rate, Pose::Identity());
    for (std::int64_t ns = 0; ns < 500'000'000; ns += 997'001) {
      const Time t{ns};
      const Time found = imu.first_stamp_from(t);
      EXPECT_GE(found, t);
      EXPECT_LT(found - t, from_seconds(1.0 / rate) + Time{1});
      EXPECT_EQ(imu.first_stamp_from(found), found);
    }
  }
}

/// The first sample of an IMU with only these errors, rotating at a constant rate.
ImuSample first_sample(const ImuConfig& config, std::uint64_t seed) {
  return Imu(config, Pose::Identity(), "test", seed, true)
      .measure(testing::UniformFlight(Pose::Identity(), Vector3d::Zero(), {0.3, -0.5, 0.8}, 1.0));
}

TEST(Imu, EachUnitHasItsOwnScaleErrorsAndLeaningAxes) {
  // While the body rotates at 1 rad/s about one axis at a time, the gyro measures the columns of
  // its response matrix.
  ImuConfig config;
  config.gyro_scale_error = 0.004;
  config.gyro_misalignment = 0.002;
  config.accel_scale_error = 0.01;
  const int units = 500;
  double on_diagonal = 0.0;
  double off_diagonal = 0.0;
  double accel_scale = 0.0;
  for (int unit = 0; unit < units; ++unit) {
    Eigen::Matrix3d response;
    for (int axis = 0; axis < 3; ++axis) {
      Imu imu(config, Pose::Identity(), "test", static_cast<std::uint64_t>(unit), true);
      const testing::UniformFlight spin(Pose::Identity(), Vector3d::Zero(), Vector3d::Unit(axis),
                                        1.0);
      const ImuSample sample = imu.measure(spin);
      response.col(axis) = sample.gyro;
      EXPECT_EQ(imu.measure(spin).gyro, sample.gyro);  // constant for a unit
      if (axis == 0) accel_scale += std::pow(sample.accel.z() / flight::kGravity - 1.0, 2);
      EXPECT_EQ(sample.accel.x(), 0.0);  // the accelerometer has no misalignment
    }
    response -= Eigen::Matrix3d::Identity();
    on_diagonal += response.diagonal().squaredNorm();
    off_diagonal += response.squaredNorm() - response.diagonal().squaredNorm();
  }
  const auto error = [](int draws) { return 4.0 / std::sqrt(2.0 * draws); };  // four sigma
  EXPECT_NEAR(std::sqrt(on_diagonal / (3 * units)) / 0.004, 1.0, error(3 * units));
  EXPECT_NEAR(std::sqrt(off_diagonal / (6 * units)) / 0.002, 1.0, error(6 * units));
  EXPECT_NEAR(std::sqrt(accel_scale / units) / 0.01, 1.0, error(units));
}

TEST(Imu, ReadsInStepsOfItsResolutionAndNoFartherThanItsRange) {
  ImuConfig config;
  config.gyro_resolution = 0.1;
  ImuSample sample = first_sample(config, 1);
  EXPECT_LT((sample.gyro - Vector3d(0.3, -0.5, 0.8)).norm(), 1e-15);
  config.gyro_resolution = 0.25;
  config.gyro_range = 0.6;
  config.accel_range = 9.0;
  sample = first_sample(config, 1);
  EXPECT_EQ(sample.gyro, Vector3d(0.25, -0.5, 0.6));
  EXPECT_EQ(sample.accel, Vector3d(0, 0, 9.0));
  config.accel_range = 0.0;
  config.accel_resolution = 2.0;
  EXPECT_EQ(first_sample(config, 1).accel, Vector3d(0, 0, 10.0));
}

/// Hovers for one second, then climbs with half of gravity.
class Climb : public flight::Flight {
 public:
  flight::Motion at(Time t) const override {
    flight::Motion motion;
    if (t >= from_seconds(1.0)) motion.acceleration_world.z() = flight::kGravity / 2;
    return motion;
  }
  Time duration() const override { return from_seconds(2.0); }
};

TEST(Imu, VibratesWithItsTonesAndHarderUnderMoreThrust) {
  VibrationTone tone;
  tone.frequency_hz = 20.0;
  tone.accel_amplitude = {0.5, 0.2, 1.5};
  tone.gyro_amplitude = {0.01, 0.0, 0.03};
  for (const bool grows : {true, false}) {
    tone.grows_with_thrust = grows;
    ImuConfig config;
    config.rate_hz = 1000.0;
    config.vibration = {tone};
    Imu imu(config, Pose::Identity(), "test", 5, true);
    const Climb climb;
    Vector3d accel_squares[2] = {Vector3d::Zero(), Vector3d::Zero()};
    Vector3d gyro_squares[2] = {Vector3d::Zero(), Vector3d::Zero()};
    for (int k = 0; k < 2000; ++k) {
      const Vector3d quiet(0, 0, k < 1000 ? flight::kGravity : 1.5 * flight::kGravity);
      const ImuSample sample = imu.measure(climb);
      accel_squares[k / 1000] += (sample.accel - quiet).cwiseAbs2();
      gyro_squares[k / 1000] += sample.gyro.cwiseAbs2();
    }
    for (int half = 0; half < 2; ++half) {
      // Over whole periods, the mean square of a sine is half its squared amplitude, for any phase.
      const double gain = half == 1 && grows ? 1.5 : 1.0;
      const Vector3d accel = (accel_squares[half] / 500).cwiseSqrt();
      const Vector3d gyro = (gyro_squares[half] / 500).cwiseSqrt();
      EXPECT_LT((accel - gain * tone.accel_amplitude).norm(), 1e-12);
      EXPECT_LT((gyro - gain * tone.gyro_amplitude).norm(), 1e-12);
    }
  }
}

/// Amplitudes of the tone of this frequency in samples at `rate_hz` (over whole periods).
Vector3d amplitudes(const std::vector<Vector3d>& samples, double frequency_hz, double rate_hz) {
  Eigen::Matrix<std::complex<double>, 3, 1> sum = Eigen::Matrix<std::complex<double>, 3, 1>::Zero();
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const double phase = 2.0 * std::numbers::pi * frequency_hz * static_cast<double>(k) / rate_hz;
    sum += samples[k].cast<std::complex<double>>() * std::polar(1.0, -phase);
  }
  return 2.0 / static_cast<double>(samples.size()) * sum.cwiseAbs();
}

/// Frequency at which a tone appears in samples that have no filter before them.
double aliased(double frequency_hz, double rate_hz) {
  return std::abs(frequency_hz - rate_hz * std::round(frequency_hz / rate_hz));
}

TEST(Imu, TheShippedVibrationIsTwoTonesOfTheStatedSizeAndNothingElse) {
  for (const char* name : {"livox_mid360", "ouster_os0_128"}) {
    const std::filesystem::path folder = LIDARENA_SOURCE_DIR "/configs/sensors";
    const ImuConfig shipped = *load_sensor(folder / (std::string(name) + "_vibrating.yaml")).imu;
    const ImuConfig still = *load_sensor(folder / (std::string(name) + ".yaml")).imu;
    ASSERT_EQ(shipped.vibration.size(), 2U);
    EXPECT_EQ(shipped.vibration[1].frequency_hz, 2.0 * shipped.vibration[0].frequency_hz);
    EXPECT_EQ(shipped.gyro_noise_density, still.gyro_noise_density);

    ImuConfig config;  // of all errors the vibration alone
    config.rate_hz = shipped.rate_hz;
    config.vibration = shipped.vibration;
    Imu imu(config, Pose::Identity(), "test", 5, true);
    Imu again(config, Pose::Identity(), "test", 5, true);
    Imu other(config, Pose::Identity(), "test", 6, true);
    const auto flight = testing::rest(Pose::Identity());
    std::vector<Vector3d> accel, gyro;
    Vector3d accel_power = Vector3d::Zero(), gyro_power = Vector3d::Zero();
    const auto count = static_cast<std::size_t>(10.0 * config.rate_hz);  // whole periods
    for (std::size_t k = 0; k < count; ++k) {
      const ImuSample sample = imu.measure(flight);
      EXPECT_EQ(sample.accel, again.measure(flight).accel);
      EXPECT_NE(sample.accel, other.measure(flight).accel) << "another unit, other phases";
      accel.emplace_back(sample.accel - Vector3d(0, 0, flight::kGravity));
      gyro.push_back(sample.gyro);
      accel_power += accel.back().cwiseAbs2() / static_cast<double>(count);
      gyro_power += gyro.back().cwiseAbs2() / static_cast<double>(count);
    }
    // A sine of amplitude A has the mean square A^2 / 2; those of different tones add up.
    Vector3d accel_expected = Vector3d::Zero(), gyro_expected = Vector3d::Zero();
    for (const VibrationTone& tone : config.vibration) {
      const double seen_hz = aliased(tone.frequency_hz, config.rate_hz);
      EXPECT_LT((amplitudes(accel, seen_hz, config.rate_hz) - tone.accel_amplitude).norm(), 1e-9);
      EXPECT_LT((amplitudes(gyro, seen_hz, config.rate_hz) - tone.gyro_amplitude).norm(), 1e-11);
      accel_expected += 0.5 * tone.accel_amplitude.cwiseAbs2();
      gyro_expected += 0.5 * tone.gyro_amplitude.cwiseAbs2();
    }
    EXPECT_LT((accel_power - accel_expected).norm(), 1e-9) << "nothing between the tones";
    EXPECT_LT((gyro_power - gyro_expected).norm(), 1e-12);
    EXPECT_LT(amplitudes(accel, 5.0, config.rate_hz).norm(), 1e-9);
    // The comment of the files: an RMS of 2 m/s^2 on each axis.
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(std::sqrt(accel_power[axis]), 2.0, 0.4);
  }
}

TEST(Imu, WithoutNoiseIsPerfectWhateverItsErrors) {
  ImuConfig config = noisy();
  config.gyro_scale_error = config.accel_scale_error = 0.1;
  config.gyro_misalignment = config.accel_misalignment = 0.1;
  config.gyro_range = config.accel_range = 0.01;
  config.gyro_resolution = config.accel_resolution = 0.3;
  config.vibration.emplace_back().accel_amplitude = Vector3d::Ones();
  Imu imu(config, Pose::Identity(), "test", 1, false);
  const testing::SwingingFlight flight(1.0);
  const ImuSample truth = perfect_imu(flight.at(Time{0}), Pose::Identity());
  const ImuSample sample = imu.measure(flight);
  EXPECT_EQ(sample.gyro, truth.gyro);
  EXPECT_EQ(sample.accel, truth.accel);
}

}  // namespace
}  // namespace lidarena::sensor
