// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/inertial_smoother.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <vector>

#include "lidarena/base/random.hpp"
#include "lidarena/base/so3.hpp"
#include "tests/estimation/random_vector.hpp"

namespace lidarena::estimation {
namespace {

using Eigen::Vector3d;
const Vector3d kGravityVector(0.0, 0.0, -9.8);
constexpr ImuNoise kNoise{1e-3, 1e-2, 1e-4, 1e-3};
constexpr double kDt = 0.005;
constexpr int kSteps = 20;  // IMU samples from one pose to the next
constexpr double kTurnSigma = 2e-3;
constexpr double kPlaceSigma = 5e-3;

PoseMeasurement::Information usual_information() {
  PoseMeasurement::Information information = PoseMeasurement::Information::Zero();
  information.diagonal() << Vector3d::Constant(1.0 / (kTurnSigma * kTurnSigma)),
      Vector3d::Constant(1.0 / (kPlaceSigma * kPlaceSigma));
  return information;
}

/// A flight: its true states, the samples of its IMU, and the measured poses.
struct Flight {
  std::vector<NavState> truth;
  std::vector<std::vector<std::pair<Vector3d, Vector3d>>> imu;  ///< by measurement
  std::vector<PoseMeasurement> measured;
};

/// A swinging motion with rotation about all axes. `noise` scales the noise of the IMU and of the
/// poses.
Flight fly(int measurements, const ImuBias& bias, double noise, std::uint64_t seed) {
  SequentialRandom random(seed, 1);
  Flight flight;
  NavState state;
  state.bias = bias;
  state.velocity = {1.0, 0.0, 0.0};
  flight.truth.push_back(state);
  double t = 0.0;
  for (int i = 0; i < measurements; ++i) {
    flight.imu.emplace_back();
    Preintegration exact(state.bias, kNoise);
    for (int k = 0; k < kSteps; ++k, t += kDt) {
      const Vector3d rate(0.4 * std::sin(1.1 * t), 0.5 * std::cos(0.9 * t), 0.6);
      const Vector3d force(2.0 * std::sin(1.7 * t), -1.5 * std::cos(1.3 * t), 9.8);
      exact.integrate(rate + state.bias.gyro, force + state.bias.accel, kDt);
      const double root = noise / std::sqrt(kDt);
      const Vector3d gyro_noise = random_vector(random, root * kNoise.gyro_density);
      const Vector3d accel_noise = random_vector(random, root * kNoise.accel_density);
      flight.imu.back().emplace_back(rate + state.bias.gyro + gyro_noise,
                                     force + state.bias.accel + accel_noise);
    }
    state = exact.predict(state, kGravityVector);
    flight.truth.push_back(state);
    const Vector3d turn = random_vector(random, noise * kTurnSigma);
    const Vector3d place = random_vector(random, noise * kPlaceSigma);
    flight.measured.push_back({make_pose(state.world_from_imu.linear() * so3::exp(turn),
                                         state.world_from_imu.translation() + place),
                               usual_information()});
  }
  return flight;
}

InertialStart start_at(const NavState& state) {
  InertialStart start;
  start.state = state;
  start.state.bias = {};
  start.gravity = kGravityVector;
  NavState::Vector sigma;
  sigma << Vector3d::Constant(1e-3), Vector3d::Constant(0.1), Vector3d::Constant(1e-3),
      Vector3d::Constant(0.02), Vector3d::Constant(0.2);
  start.covariance = sigma.cwiseAbs2().asDiagonal();
  return start;
}

void play(const Flight& flight, InertialSmoother& smoother) {
  for (std::size_t i = 0; i < flight.imu.size(); ++i) {
    Preintegration sum(smoother.latest().bias, kNoise);
    for (const auto& [gyro, accel] : flight.imu[i]) sum.integrate(gyro, accel, kDt);
    smoother.add(sum, flight.measured[i]);
  }
}

TEST(InertialSmoother, FindsBiasesAndVelocityOfAPerfectFlight) {
  const ImuBias bias{{0.01, -0.02, 0.015}, {0.1, -0.15, 0.2}};
  const Flight flight = fly(60, bias, 0.0, 1);
  InertialSmoother smoother;
  InertialStart start = start_at(flight.truth.front());
  start.state.velocity += Vector3d(0.1, -0.1, 0.05);
  smoother.start(start);
  play(flight, smoother);
  const NavState::Vector error = minus(smoother.latest(), flight.truth.back());
  // The bounds are the largest standard deviations in the covariance of the smoother, from the
  // random walk of the biases and the initial sigmas.
  EXPECT_LT(error.segment<3>(NavState::kGyroBias).norm(), 1e-4);
  EXPECT_LT(error.segment<3>(NavState::kAccelBias).norm(), 5e-3);
  EXPECT_LT(error.segment<3>(NavState::kVelocity).norm(), 1e-3);
  EXPECT_LT(error.segment<3>(NavState::kPosition).norm(), 1e-4);
}

TEST(InertialSmoother, AShortLagGivesWhatAllMeasurementsAtOnceGive) {
  const Flight flight = fly(30, {{0.01, 0.0, -0.01}, {0.05, 0.1, 0.0}}, 1.0, 2);
  const InertialStart start = start_at(flight.truth.front());
  InertialSmoother all(1000);
  InertialSmoother some(5);
  all.start(start);
  some.start(start);
  play(flight, all);
  play(flight, some);
  EXPECT_EQ(all.size(), 31U);
  EXPECT_EQ(some.size(), 6U);
  const NavState::Vector apart = minus(some.latest(), all.latest());
  const NavState::Vector sigma = all.covariance().diagonal().cwiseSqrt();
  // Marginalization keeps the Jacobians computed at that time: the difference is of second order in
  // errors that are small compared to one radian, hence small compared to one sigma.
  EXPECT_LT(apart.cwiseQuotient(sigma).cwiseAbs().maxCoeff(), 0.1);
  const NavState::Vector ratio = some.covariance().diagonal().cwiseQuotient(sigma.cwiseAbs2());
  EXPECT_LT((ratio.array() - 1.0).abs().maxCoeff(), 0.05);
}

TEST(InertialSmoother, ItsCovarianceIsHonest) {
  // chi-squared of 15 errors: mean 15, standard deviation sqrt(30); over 60 flights +-0.71
  constexpr int kFlights = 60;
  double sum = 0.0;
  for (int seed = 0; seed < kFlights; ++seed) {
    SequentialRandom random(100 + static_cast<std::uint64_t>(seed), 2);
    const ImuBias bias{random_vector(random, 0.02), random_vector(random, 0.2)};
    const Flight flight = fly(20, bias, 1.0, static_cast<std::uint64_t>(seed));
    InertialStart start = start_at(flight.truth.front());
    NavState::Vector off;  // initial position and attitude are nearly known
    off << random_vector(random, 1e-3), random_vector(random, 0.1), random_vector(random, 1e-3),
        Vector3d::Zero(), Vector3d::Zero();
    start.state = plus(start.state, off);
    InertialSmoother smoother;
    smoother.start(start);
    play(flight, smoother);
    const NavState::Vector error = minus(smoother.latest(), flight.truth.back());
    sum += error.dot(smoother.covariance().ldlt().solve(error)) / kFlights;
  }
  // The true biases are constant and the smoother assumes random walks, so the value is a little
  // lower.
  EXPECT_GT(sum, 15.0 - 5.0 * 0.71);
  EXPECT_LT(sum, 15.0 + 3.0 * 0.71);
}

TEST(InertialSmoother, AMeasurementWithoutInformationIsAPrediction) {
  Flight flight = fly(5, {}, 0.0, 4);
  for (PoseMeasurement& measured : flight.measured) {
    measured.information.setZero();
    measured.world_from_imu = Pose::Identity();
  }
  InertialSmoother smoother;
  smoother.start(start_at(flight.truth.front()));
  play(flight, smoother);
  EXPECT_LT(minus(smoother.latest(), flight.truth.back()).norm(), 1e-6);
}

}  // namespace
}  // namespace lidarena::estimation
