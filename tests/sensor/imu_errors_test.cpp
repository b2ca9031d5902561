// SPDX-License-Identifier: BSD-3-Clause
// Bandwidth, timing, distortion and broadband vibration of an IMU, and what a rig tells about it,
// compared with closed forms and statistics.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "lidarena/sensor/imu.hpp"
#include "lidarena/sensor/simulate.hpp"
#include "tests/sensor/flights.hpp"
#include "tests/sensor/worlds.hpp"

namespace lidarena::sensor {
namespace {

using Eigen::Vector3d;
using namespace testing;

std::vector<ImuSample> samples_of(const ImuConfig& config, const flight::Flight& flight, int count,
                                  std::uint64_t seed = 1) {
  Imu imu(config, Pose::Identity(), "test", seed, true);
  std::vector<ImuSample> samples;
  for (int k = 0; k < count; ++k) samples.push_back(imu.measure(flight));
  return samples;
}

/// Magnitude per Hz of a sampled signal's amplitude at `hz`: 2 / n |sum x exp(-i w t)|.
double amplitude_at(const std::vector<double>& values, double rate_hz, double hz) {
  std::complex<double> sum = 0.0;
  for (std::size_t k = 0; k < values.size(); ++k)
    sum += values[k] *
           std::polar(1.0, -2.0 * std::numbers::pi * hz * static_cast<double>(k) / rate_hz);
  return 2.0 * std::abs(sum) / static_cast<double>(values.size());
}

TEST(ImuBandwidth, WeakensATonePastTheCutoffAsAButterworthFilterOfSecondOrder) {
  for (const double hz : {10.0, 50.0, 90.0, 150.0, 330.0}) {  // 150 and 330 are aliased
    ImuConfig config;
    config.bandwidth_hz = 50.0;
    config.vibration.push_back({hz, {2.0, 0, 0}, {0.1, 0, 0}, true});
    const auto samples = samples_of(config, rest(Pose::Identity(), 30), 2100);
    std::vector<double> accel, gyro;
    for (std::size_t k = 100; k < samples.size(); ++k) {  // once the filter has settled
      accel.push_back(samples[k].accel.x());
      gyro.push_back(samples[k].gyro.x());
    }
    const double gain = 1.0 / std::sqrt(1.0 + std::pow(hz / 50.0, 4));
    const double seen_hz = std::abs(hz - 200.0 * std::round(hz / 200.0));
    EXPECT_NEAR(amplitude_at(accel, 200, seen_hz), 2.0 * gain, 0.04 * gain + 2e-3) << hz;
    EXPECT_NEAR(amplitude_at(gyro, 200, seen_hz), 0.1 * gain, 0.002 * gain + 1e-4) << hz;
  }
}

TEST(ImuBandwidth, DelaysASlowMotionByItsGroupDelayAndKeepsItsSize) {
  ImuConfig config;
  config.bandwidth_hz = 60.0;
  const double delay = std::numbers::sqrt2 / (2.0 * std::numbers::pi * 60.0);
  const SwingingFlight flight(8.0);
  const auto samples = samples_of(config, flight, 1000);
  for (std::size_t k = 200; k < samples.size(); ++k) {
    const Time then = samples[k].stamp - from_seconds(delay);
    const ImuSample expected = perfect_imu(flight.at(then), Pose::Identity());
    EXPECT_LT((samples[k].gyro - expected.gyro).norm(), 1e-3);
    EXPECT_LT((samples[k].accel - expected.accel).norm(), 2e-2);
  }
}

TEST(ImuTiming, ADelayedSampleIsTheMotionOfAnEarlierTime) {
  ImuConfig config;
  config.delay_s = 0.007;
  const SwingingFlight flight(3.0);
  for (const ImuSample& sample : samples_of(config, flight, 400)) {
    const ImuSample expected =
        perfect_imu(flight.at(sample.stamp - from_seconds(0.007)), Pose::Identity());
    EXPECT_LT((sample.gyro - expected.gyro).norm(), 1e-12);
    EXPECT_LT((sample.accel - expected.accel).norm(), 1e-12);
  }
}

TEST(ImuTiming, JitterOfStampsHasTheGivenSigmaKeepsTheOrderAndTheSamples) {
  ImuConfig plain;
  plain.gyro_noise_density = 1e-3;
  ImuConfig config = plain;
  config.stamp_jitter_s = 0.0005;
  const auto flight = rest(Pose::Identity(), 100);
  const int count = 8000;
  const auto exact = samples_of(plain, flight, count), samples = samples_of(config, flight, count);
  double squares = 0.0, products = 0.0, last = 0.0;
  for (std::size_t k = 1; k < samples.size(); ++k) {
    EXPECT_GT(samples[k].stamp, samples[k - 1].stamp);
    EXPECT_EQ(samples[k].gyro, exact[k].gyro);
    const double error = to_seconds(samples[k].stamp - exact[k].stamp);
    squares += error * error;
    products += error * last;
    last = error;
  }
  EXPECT_NEAR(std::sqrt(squares / count) / 0.0005, 1.0, 4.0 / std::sqrt(2.0 * count));
  EXPECT_NEAR(products / squares, 0.0, 4.0 / std::sqrt(count));
}

TEST(ImuTiming, LostSamplesAreTheGivenShareAndTheOthersAreAsTheyWere) {
  ImuConfig plain;
  plain.gyro_noise_density = 1e-3;
  plain.accel_bias_walk = 1e-3;
  ImuConfig config = plain;
  config.lost_share = 0.1;
  const auto flight = rest(Pose::Identity(), 100);
  const auto all = samples_of(plain, flight, 12'000), some = samples_of(config, flight, 10'000);
  std::size_t k = 0;
  for (const ImuSample& sample : some) {
    while (all[k].stamp < sample.stamp) ++k;
    ASSERT_EQ(all[k].stamp, sample.stamp);
    EXPECT_EQ(all[k].gyro, sample.gyro);
    EXPECT_EQ(all[k].accel, sample.accel);
  }
  const double count = static_cast<double>(k + 1);
  EXPECT_NEAR(1.0 - 10'000.0 / count, 0.1, 4.0 * std::sqrt(0.1 * 0.9 / count));

  Imu imu(config, Pose::Identity(), "test", 1, true);
  for (int i = 0; i < 200; ++i) {  // the next stamp is that of the sample which is then delivered
    const Time next = imu.next_stamp();
    EXPECT_EQ(imu.first_stamp_from(next), next);
    EXPECT_EQ(imu.measure(flight).stamp, next);
  }
}

TEST(ImuTiming, SharesTheClockOfItsLidar) {
  ImuConfig config;
  const ClockConfig shared{0.02, 1e-3, 0.5, true};
  Imu imu(config, Pose::Identity(), "test", 1, true, shared);
  for (int k = 0; k < 100; ++k)
    EXPECT_NEAR(to_seconds(imu.measure(rest(Pose::Identity())).stamp), 0.02 + 1.001 * k / 200.0,
                1e-9);
  Imu apart(config, Pose::Identity(), "test", 1, true, {0.02, 1e-3, 0.5, false});
  EXPECT_EQ(apart.next_stamp(), Time{0});
}

TEST(ImuDistortion, TheGyroFeelsTheSpecificForceByAMatrixOfTheGivenSigma) {
  ImuConfig config;
  config.gyro_g_sensitivity = 2e-4;
  const int units = 2000;
  double squares = 0.0;
  for (int seed = 0; seed < units; ++seed) {
    Imu imu(config, Pose::Identity(), "test", static_cast<std::uint64_t>(seed), true);
    squares += imu.measure(rest(Pose::Identity())).gyro.squaredNorm();
  }
  const double sigma = 2e-4 * flight::kGravity;
  EXPECT_NEAR(std::sqrt(squares / (3 * units)) / sigma, 1.0, 4.0 / std::sqrt(6.0 * units));

  // The same matrix in all attitudes: the response to the sum of two forces is the sum.
  const auto felt = [&](const Pose& pose) {
    Imu imu(config, Pose::Identity(), "test", 5, true);
    return imu.measure(rest(pose)).gyro;
  };
  const Vector3d up = felt(Pose::Identity());
  const Vector3d side = felt(tilted_pose({0, 0, 0}, radians(-90), 0, 0));
  const Vector3d between = felt(tilted_pose({0, 0, 0}, radians(-45), 0, 0));
  EXPECT_LT((between - (up + side) / std::numbers::sqrt2).norm(), 1e-12);
}

TEST(ImuDistortion, NonlinearityIsQuadraticAndHasTheGivenSigmaAtFullRange) {
  ImuConfig config;
  config.gyro_range = 10.0;
  config.accel_range = 100.0;
  config.gyro_nonlinearity = 0.002;
  config.accel_nonlinearity = 0.001;
  const auto error_of = [&](double rate, std::uint64_t seed) {
    Imu imu(config, Pose::Identity(), "test", seed, true);
    const UniformFlight spin(Pose::Identity(), Vector3d::Zero(), {0, 0, rate}, 1);
    return imu.measure(spin).gyro.z() - rate;
  };
  EXPECT_NEAR(error_of(8, 3), 16.0 * error_of(2, 3), 1e-12);
  EXPECT_NEAR(error_of(-8, 3), error_of(8, 3), 1e-12);
  const int units = 2000;
  double gyro = 0.0, accel = 0.0;
  for (int i = 0; i < units; ++i) {
    const auto seed = static_cast<std::uint64_t>(i);
    gyro += std::pow(error_of(5, seed) / 0.25, 2);  // a quarter of the error at full range
    Imu imu(config, Pose::Identity(), "test", seed, true);
    const double error = imu.measure(rest(Pose::Identity())).accel.z() - flight::kGravity;
    accel += std::pow(error * std::pow(100.0 / flight::kGravity, 2), 2);
  }
  const double tolerance = 4.0 / std::sqrt(2.0 * units);
  EXPECT_NEAR(std::sqrt(gyro / units) / (0.002 * 10.0), 1.0, tolerance);
  EXPECT_NEAR(std::sqrt(accel / units) / (0.001 * 100.0), 1.0, tolerance);
}

TEST(ImuGravity, IsThatOfThePlace) {
  ImuConfig config;
  config.gravity = 9.78;
  for (const bool noise : {true, false}) {
    Imu imu(config, Pose::Identity(), "test", 1, noise);
    EXPECT_LT((imu.measure(rest(Pose::Identity())).accel - Vector3d(0, 0, 9.78)).norm(), 1e-14);
  }
}

/// Climbs with a constant acceleration, for a thrust other than that in hover.
class SteadyClimb : public flight::Flight {
 public:
  explicit SteadyClimb(double acceleration) : acceleration_(acceleration) {}
  flight::Motion at(Time) const override {
    flight::Motion motion;
    motion.acceleration_world = {0, 0, acceleration_};
    return motion;
  }
  Time duration() const override { return std::chrono::hours(1); }

 private:
  double acceleration_;
};

/// Share of the variance between two frequencies, by numeric integration of the model's formula.
double expected_share(const BroadbandConfig& c, double thrust, double from, double to) {
  const auto normal = [](double x, double mean, double sigma) {
    return 0.5 * std::erfc((mean - x) / (sigma * std::numbers::sqrt2));
  };
  const double rotor = c.rotor_hz * std::sqrt(thrust), blades = c.blades * rotor;
  const auto until = [&](double f) {
    return c.floor_share * (f - c.low_hz) / (c.high_hz - c.low_hz) +
           0.5 * (1 - c.floor_share) *
               (normal(f, rotor, c.spread * rotor) + normal(f, blades, c.spread * blades));
  };
  return until(to) - until(from);
}

TEST(BroadbandVibration, HasTheSpectrumOfTheModelAndFollowsTheRotors) {
  ImuConfig config;
  config.rate_hz = 1200.0;  // the whole band is below half of it
  config.broadband.accel_rms = {2.0, 1.0, 3.0};
  config.broadband.gyro_rms = {0.1, 0.2, 0.3};
  for (const double thrust : {1.0, 1.44}) {
    // The variance of each band of frequencies, over 20 units; 2 s each, so cells of 0.5 Hz.
    const std::vector<double> edges{10, 90, 110, 125, 145, 165, 220, 300, 400, 500};
    std::vector<double> variance(edges.size() - 1, 0.0);
    double total = 0.0;
    const SteadyClimb climb((thrust - 1.0) * flight::kGravity);
    const int units = 20, count = 2400;
    for (int unit = 0; unit < units; ++unit) {
      const auto samples = samples_of(config, climb, count, static_cast<std::uint64_t>(unit));
      std::vector<double> x;
      for (const ImuSample& s : samples) x.push_back(s.accel.z() - thrust * flight::kGravity);
      for (const double value : x) total += value * value / (units * count);
      for (std::size_t band = 0; band + 1 < edges.size(); ++band) {
        for (double hz = edges[band] + 0.25; hz < edges[band + 1]; hz += 0.5) {
          const double a = amplitude_at(x, config.rate_hz, hz);
          variance[band] += 0.5 * a * a / units;
        }
      }
    }
    const double whole = std::pow(3.0 * thrust, 2);
    EXPECT_NEAR(total / whole, 1.0, 0.05) << thrust;
    for (std::size_t band = 0; band < variance.size(); ++band) {
      const double expected =
          expected_share(config.broadband, thrust, edges[band], edges[band + 1]);
      // The lines nearest to an edge may lie on either side of it: 4 Hz of 3.8 Hz strata.
      EXPECT_NEAR(variance[band] / whole, expected, 0.1 * expected + 0.02)
          << thrust << " " << edges[band];
    }
  }
}

TEST(BroadbandVibration, IsIndependentFromAxisToAxisAndChangesNoOtherNoise) {
  ImuConfig plain;
  plain.gyro_noise_density = 1e-3;
  plain.accel_turn_on_bias = 0.1;
  plain.vibration.push_back({100, {1, 1, 1}, {0.1, 0.1, 0.1}, true});
  ImuConfig config = plain;
  config.broadband.accel_rms = {2, 2, 2};
  config.broadband.gyro_rms = {0.1, 0.1, 0.1};
  const auto flight = rest(Pose::Identity(), 100);
  const int count = 16'000;
  const auto before = samples_of(plain, flight, count), after = samples_of(config, flight, count);
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  for (std::size_t k = 0; k < before.size(); ++k) {
    Vibration::Vector6 added;
    added << (after[k].accel - before[k].accel) / 2.0, (after[k].gyro - before[k].gyro) / 0.1;
    covariance += added * added.transpose() / count;
  }
  // What was added has the variance of the broadband vibration alone.
  EXPECT_LT((covariance - Eigen::Matrix<double, 6, 6>::Identity()).cwiseAbs().maxCoeff(), 0.3);
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(covariance(i, i), 1.0, 0.06);
}

TEST(Told, TheRigSaysWhatIsToldAndTheImuMeasuresWhatIsSo) {
  SensorConfig config = mid360();
  ImuConfig& imu = config.imu.emplace();
  imu.gyro_noise_density = 1e-3;
  imu.accel_bias_walk = 1e-4;
  imu.lidar_from_imu = make_pose(Eigen::Quaterniond::Identity(), {0.01, 0.02, -0.04});
  const Rig so = make_rig({config});
  SensorConfig told = config;
  told.told.noise_factor = 10.0;
  told.told.bias_walk_factor = 0.1;
  told.told.lidar_from_imu = make_pose(Eigen::Quaterniond(1, 0.02, 0, 0), {0.03, 0.02, -0.04});
  const Rig rig = make_rig({told});
  EXPECT_NEAR(rig.imus[0].gyro_noise_density, 1e-2, 1e-15);
  EXPECT_NEAR(rig.imus[0].accel_bias_walk, 1e-5, 1e-15);
  EXPECT_TRUE(
      rig.imus[0].body_from_imu.isApprox(config.body_from_lidar * *told.told.lidar_from_imu));
  EXPECT_TRUE(rig.lidars[0].body_from_lidar.isApprox(so.lidars[0].body_from_lidar));

  const world::World wall(wall_mesh(5.0), "wall", world::RayCaster::kBvh);
  const SwingingFlight flight(0.5);
  const auto a = simulate(wall, flight, {config}, {}, Parallel(1));
  const auto b = simulate(wall, flight, {told}, {}, Parallel(1));
  while (const auto event = a->next()) {
    const auto other = b->next();
    ASSERT_TRUE(other);
    if (const auto* sample = std::get_if<ImuSample>(&event->data)) {
      EXPECT_EQ(sample->accel, std::get<ImuSample>(other->data).accel);
    } else {
      EXPECT_TRUE(same(std::get<Scan>(event->data), std::get<Scan>(other->data)));
    }
  }
}

}  // namespace
}  // namespace lidarena::sensor
