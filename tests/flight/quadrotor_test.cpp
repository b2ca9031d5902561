// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/quadrotor.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "lidarena/flight/flight.hpp"
#include "lidarena/flight/gusts.hpp"
#include "tests/flight/quadrotor_scenes.hpp"

namespace lidarena::flight {
namespace {

using Eigen::Array4d;
using Eigen::Vector3d;
using test_scenes::integrated;

const Vector3d kStill = Vector3d::Zero();

Array4d hover_speeds(const DynamicsConfig& c) {
  return Array4d::Constant(std::sqrt(c.mass_kg * kGravity / (4.0 * c.max_thrust)));
}

TEST(Quadrotor, HoversWhereFourEqualThrustsCarryItsWeight) {
  const Quadrotor quad{DynamicsConfig{}};
  QuadrotorState state;
  state.rotor_speed = hover_speeds(quad.config());
  EXPECT_NEAR(quad.wrench(state.rotor_speed).thrust, 1.5 * kGravity, 1e-12);
  const QuadrotorRate rate = quad.derivative(state, state.rotor_speed, kStill);
  EXPECT_NEAR(rate.velocity.norm(), 0.0, 1e-12);
  EXPECT_NEAR(rate.rate.norm(), 0.0, 1e-12);
  EXPECT_EQ(rate.rotor_speed.matrix().norm(), 0.0);
}

TEST(Quadrotor, FallsFreelyWithoutThrustAndDrag) {
  DynamicsConfig config;
  config.drag_per_s = 0.0;
  const Quadrotor quad{config};
  QuadrotorState state;
  state.velocity = {1.0, -2.0, 3.0};
  const QuadrotorState end = integrated(state, 2.0, 0.01, [&](double, const QuadrotorState& s) {
    return quad.derivative(s, Array4d::Zero(), kStill);
  });
  const Vector3d expected = 2.0 * state.velocity - 0.5 * kGravity * 4.0 * Vector3d::UnitZ();
  EXPECT_NEAR((end.position - expected).norm(), 0.0, 1e-12);
}

TEST(Quadrotor, FallsAtTheTiltOfItsDragAcrossTheThrustOnly) {
  const Quadrotor quad{DynamicsConfig{}};
  const Eigen::Matrix3d level = Eigen::Matrix3d::Identity();
  const double d = 1.5 * quad.config().drag_per_s;
  EXPECT_NEAR((quad.drag(level, {2.0, -1.0, 5.0}) - Vector3d(-2.0 * d, d, 0.0)).norm(), 0.0, 1e-12);
}

TEST(Quadrotor, ARotorsSpeedReachesItsCommandWithTheLagsTimeConstant) {
  const Quadrotor quad{DynamicsConfig{}};
  const double lag = quad.config().motor_lag_s;
  const auto towards_half = [&](double, const QuadrotorState& s) {
    return quad.derivative(s, Array4d::Constant(0.5), kStill);
  };
  for (const double t : {lag, 3.0 * lag}) {
    const QuadrotorState end = integrated({}, t, lag / 100.0, towards_half);
    const double speed = 0.5 * (1.0 - std::exp(-t / lag));
    EXPECT_NEAR(end.rotor_speed[0], speed, 1e-9);
    // the thrust is proportional to the square of the speed
    EXPECT_NEAR(quad.wrench(end.rotor_speed).thrust, 4.0 * 7.1 * speed * speed, 1e-7);
  }
}

TEST(Quadrotor, EachRotorTurnsTheBodyTheWayItsPlaceAndSenseSay) {
  const Quadrotor quad{DynamicsConfig{}};
  const double arm = 0.25 / std::sqrt(2.0);
  const Vector3d places[] = {{arm, arm, 0}, {arm, -arm, 0}, {-arm, arm, 0}, {-arm, -arm, 0}};
  double about_z = 0.0;
  for (int i = 0; i < 4; ++i) {
    Array4d one = Array4d::Zero();
    one[i] = 1.0;
    const Wrench w = quad.wrench(one);
    const Vector3d moment = places[i].cross(Vector3d(0.0, 0.0, 7.1));
    EXPECT_NEAR((w.torque - moment).head<2>().norm(), 0.0, 1e-12);
    EXPECT_NEAR(std::abs(w.torque.z()), 0.06 * 7.1, 1e-12);
    about_z += w.torque.z();
  }
  EXPECT_NEAR(about_z, 0.0, 1e-12);
}

TEST(Quadrotor, SpeedsGiveTheWantedWrenchAndYawGivesWayFirst) {
  const Quadrotor quad{DynamicsConfig{}};
  const Wrench within{.thrust = 15.0, .torque = {0.4, -0.3, 0.2}};
  const Wrench got = quad.wrench(quad.speeds_for(within));
  EXPECT_NEAR(got.thrust, 15.0, 1e-12);
  EXPECT_NEAR((got.torque - within.torque).norm(), 0.0, 1e-12);

  const Wrench much{.thrust = 15.0, .torque = {0.4, -0.3, 50.0}};
  const Array4d speeds = quad.speeds_for(much);
  const Wrench clipped = quad.wrench(speeds);
  EXPECT_NEAR(clipped.thrust, 15.0, 1e-12);
  EXPECT_NEAR((clipped.torque - much.torque).head<2>().norm(), 0.0, 1e-12);
  EXPECT_GT(clipped.torque.z(), 0.2);
  EXPECT_LT(clipped.torque.z(), 1.0);

  const Array4d full = quad.speeds_for({.thrust = 1000.0, .torque = {0, 0, 1}});
  EXPECT_TRUE((full == 1.0).all());
}

TEST(Quadrotor, TumblingFreelyKeepsItsEnergyAndItsAngularMomentum) {
  DynamicsConfig config;
  config.drag_per_s = 0.0;
  config.inertia = {0.02, 0.03, 0.06};
  const Quadrotor quad{config};
  QuadrotorState state;
  state.velocity = {1.0, 2.0, 3.0};
  state.rate = {4.0, -3.0, 2.0};
  const auto energy = [&](const QuadrotorState& s) {
    return 0.5 * s.rate.dot(config.inertia.cwiseProduct(s.rate)) +
           config.mass_kg * (0.5 * s.velocity.squaredNorm() + kGravity * s.position.z());
  };
  const auto momentum = [&](const QuadrotorState& s) -> Vector3d {
    return s.attitude * config.inertia.cwiseProduct(s.rate);
  };
  const QuadrotorState end = integrated(state, 5.0, 0.002, [&](double, const QuadrotorState& s) {
    return quad.derivative(s, Array4d::Zero(), kStill);
  });
  EXPECT_GT(end.attitude.angularDistance(state.attitude), 0.1);
  EXPECT_NEAR(energy(end), energy(state), 1e-8 * energy(state));
  EXPECT_NEAR((momentum(end) - momentum(state)).norm(), 0.0, 1e-8 * momentum(state).norm());
}

TEST(Quadrotor, TheIntegratorsErrorFallsWithTheFourthPowerOfItsStep) {
  const Quadrotor quad{DynamicsConfig{}};
  GustConfig wind;
  wind.gust_speed = 2.0;
  const Gusts gusts(wind);
  QuadrotorState state;
  state.rate = {0.4, 0.2, -0.3};
  state.rotor_speed = hover_speeds(quad.config());
  const auto flying = [&](double t, const QuadrotorState& s) {
    Array4d command = hover_speeds(quad.config());
    command += 0.02 * Array4d(std::sin(9 * t), std::cos(7 * t), std::sin(11 * t), std::cos(8 * t));
    return quad.derivative(s, command, gusts.at(t + 1.0));
  };
  const QuadrotorState exact = integrated(state, 1.0, 0.00025, flying);
  const auto error = [&](double h) {
    const QuadrotorState end = integrated(state, 1.0, h, flying);
    return (end.position - exact.position).norm() + end.attitude.angularDistance(exact.attitude);
  };
  const double ratio = error(0.004) / error(0.002);
  EXPECT_GT(ratio, 14.0);
  EXPECT_LT(ratio, 18.0);
}

}  // namespace
}  // namespace lidarena::flight
