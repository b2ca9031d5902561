// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/imu.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "lidarena/base/so3.hpp"
#include "tests/sensor/flights.hpp"

namespace lidarena {
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
  EXPECT_LT((sample.accel - Vector3d(0, 0, kGravity)).norm(), 1e-14);
  EXPECT_TRUE(sample.gyro.isZero());

  // Lying on its left side, up is the body's -y; an IMU turned half about x calls that +y.
  const Pose on_side = testing::tilted_pose({1, 2, 3}, testing::radians(-90), 0, 0.4);
  sample = perfect(200, level).measure(testing::rest(on_side));
  EXPECT_LT((sample.accel - Vector3d(0, -kGravity, 0)).norm(), 1e-12);
  const Pose flipped = testing::tilted_pose({0.1, 0.2, 0.3}, testing::radians(180), 0, 0);
  sample = perfect(200, flipped).measure(testing::rest(on_side));
  EXPECT_LT((sample.accel - Vector3d(0, kGravity, 0)).norm(), 1e-12);
}

TEST(Imu, OnALeverArmFeelsTheCentripetalForceOfASteadySpin) {
  const double rate = 3.0;
  const testing::UniformFlight spin(Pose::Identity(), Vector3d::Zero(), {0, 0, rate}, 2.0);
  const Pose on_arm = make_pose(Quaterniond::Identity(), {0.5, 0, 0.2});
  Imu imu = perfect(100, on_arm);
  for (int k = 0; k < 50; ++k) {
    const ImuSample sample = imu.measure(spin);
    EXPECT_LT((sample.accel - Vector3d(-rate * rate * 0.5, 0, kGravity)).norm(), 1e-12);
    EXPECT_LT((sample.gyro - Vector3d(0, 0, rate)).norm(), 1e-14);
  }
}

struct State {
  Quaterniond attitude;
  Vector3d velocity;
  Vector3d position;
};

struct Rate {
  Eigen::Vector4d attitude;  // x y z w
  Vector3d velocity;
  Vector3d position;
};

Rate rate_of(const State& s, const ImuSample& imu) {
  const Quaterniond turning(0.0, imu.gyro.x(), imu.gyro.y(), imu.gyro.z());
  return {0.5 * (s.attitude * turning).coeffs(),
          s.attitude.normalized() * imu.accel - Vector3d(0, 0, kGravity), s.velocity};
}

State advanced(const State& s, const Rate& rate, double h) {
  State next = s;
  next.attitude.coeffs() += h * rate.attitude;
  next.velocity += h * rate.velocity;
  next.position += h * rate.position;
  return next;
}

/// One step of the classical Runge-Kutta method over three samples, h apart from first to last.
State runge_kutta(const State& s, const ImuSample* imu, double h) {
  const Rate k1 = rate_of(s, imu[0]);
  const Rate k2 = rate_of(advanced(s, k1, h / 2), imu[1]);
  const Rate k3 = rate_of(advanced(s, k2, h / 2), imu[1]);
  const Rate k4 = rate_of(advanced(s, k3, h), imu[2]);
  State next = advanced(s, k1, h / 6);
  next = advanced(next, k2, h / 3);
  next = advanced(next, k3, h / 3);
  next = advanced(next, k4, h / 6);
  next.attitude.normalize();
  return next;
}

TEST(Imu, NoiseFreeSamplesIntegrateToTheFlightTheyCameFrom) {
  const testing::SwingingFlight flight(10.0);
  const Pose body_from_imu = testing::tilted_pose({0.2, -0.1, 0.3}, 0.5, -1.0, 2.0);
  Imu imu = perfect(4000, body_from_imu);
  std::vector<ImuSample> samples;
  while (imu.next_stamp() <= flight.duration()) samples.push_back(imu.measure(flight));
  ASSERT_EQ(samples.size(), 40'001U);

  const Motion start = flight.at(Time{0});
  const Pose first = start.world_from_body * body_from_imu;
  const Vector3d arm = body_from_imu.translation();
  State state{
      Quaterniond(first.linear()),
      start.velocity_world + start.world_from_body.linear() * start.angular_rate_body.cross(arm),
      first.translation()};
  for (std::size_t k = 0; k + 2 < samples.size(); k += 2) {
    state = runge_kutta(state, &samples[k], 2.0 / 4000);
  }
  const Pose last = flight.pose_at(flight.duration()) * body_from_imu;
  // The method's error is of order h^4 = 6e-14 per second of second-long motions.
  EXPECT_LT((state.position - last.translation()).norm(), 1e-8);
  EXPECT_LT(so3::angle(state.attitude.toRotationMatrix().transpose() * last.linear()), 1e-9);
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
    accel_squares += (sample.accel - Vector3d(0, 0, kGravity)).cwiseAbs2();
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
    EXPECT_EQ(first.gyro, last.gyro);  // nothing but the turn-on bias moves this gyro
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
    const ImuSample twin = b.measure(flight);
    EXPECT_EQ(sample.gyro, twin.gyro);
    EXPECT_EQ(sample.accel, twin.accel);
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

}  // namespace
}  // namespace lidarena
