// SPDX-License-Identifier: BSD-3-Clause
// Integrating the samples of an error-free IMU must reproduce the flight; it does only if rate,
// specific force, lever arm, gravity and stamps are all correct.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "lidarena/base/so3.hpp"
#include "lidarena/flight/spline_flight.hpp"
#include "lidarena/sensor/imu.hpp"
#include "tests/sensor/flights.hpp"

namespace lidarena::sensor {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

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
  const Quaterniond rate_quaternion(0.0, imu.gyro.x(), imu.gyro.y(), imu.gyro.z());
  return {0.5 * (s.attitude * rate_quaternion).coeffs(),
          s.attitude.normalized() * imu.accel - Vector3d(0, 0, flight::kGravity), s.velocity};
}

State advanced(const State& s, const Rate& rate, double h) {
  State next = s;
  next.attitude.coeffs() += h * rate.attitude;
  next.velocity += h * rate.velocity;
  next.position += h * rate.position;
  return next;
}

/// One step of the classical Runge-Kutta method over three samples; h: from the first to the last.
State runge_kutta(State s, const ImuSample* imu, double h) {
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

/// One step over three samples with the second-order method of many estimators: mean rate over each
/// interval, mean of the forces at its ends.
State midpoint(State s, const ImuSample* imu, double h) {
  for (int i = 0; i < 2; ++i) {
    const double dt = h / 2;
    const Vector3d rotation = dt / 2 * (imu[i].gyro + imu[i + 1].gyro);
    const Quaterniond next = s.attitude * Quaterniond(so3::exp(rotation));
    const Vector3d acceleration = (s.attitude * imu[i].accel + next * imu[i + 1].accel) / 2 -
                                  Vector3d(0, 0, flight::kGravity);
    s.position += dt * s.velocity + dt * dt / 2 * acceleration;
    s.velocity += dt * acceleration;
    s.attitude = next.normalized();
  }
  return s;
}

using Method = State (*)(State, const ImuSample*, double);

/// Error at the end of `flight` of the integral of an IMU's samples.
struct EndError {
  double position_m;
  double angle_deg;
};

EndError integrate(const flight::Flight& flight, const Pose& body_from_imu, double rate_hz,
                   Method method) {
  ImuConfig config;
  config.rate_hz = rate_hz;
  Imu imu(config, body_from_imu, "test", 1, false);
  std::vector<ImuSample> samples;
  while (imu.next_stamp() <= flight.duration()) samples.push_back(imu.measure(flight));
  EXPECT_EQ(samples.size() % 2, 1U);
  EXPECT_EQ(samples.back().stamp, flight.duration());

  const flight::Motion start = flight.at(Time{0});
  const Pose first = start.world_from_body * body_from_imu;
  const Vector3d arm = body_from_imu.translation();
  State state{
      Quaterniond(first.linear()),
      start.velocity_world + start.world_from_body.linear() * start.angular_rate_body.cross(arm),
      first.translation()};
  for (std::size_t k = 0; k + 2 < samples.size(); k += 2) {
    state = method(state, &samples[k], 2.0 / rate_hz);
  }
  const Pose last = flight.pose_at(flight.duration()) * body_from_imu;
  return {
      (state.position - last.translation()).norm(),
      testing::degrees(so3::angle(state.attitude.toRotationMatrix().transpose() * last.linear()))};
}

const Pose kMount = testing::tilted_pose({0.2, -0.1, 0.3}, 0.5, -1.0, 2.0);

TEST(ImuIntegration, GivesBackAFlightInClosedForm) {
  const EndError error = integrate(testing::SwingingFlight(10.0), kMount, 4000, runge_kutta);
  // The error of the method is of order h^4 = 6e-14 per second, for motions with periods of
  // seconds.
  EXPECT_LT(error.position_m, 1e-8);
  EXPECT_LT(error.angle_deg, 1e-7);
}

/// One minute of aggressive flight through a hall.
std::unique_ptr<flight::Flight> aggressive_minute() {
  flight::FlightConfig config;
  config.style = flight::FlightStyle::kAggressive;
  config.duration_s = 60.0;
  const std::vector<Vector3d> waypoints{{0, 0, 1}, {8, 1, 2},  {9, 6, 1.2}, {3, 7, 3},
                                        {4, 3, 1}, {-3, 5, 2}, {-4, -2, 1}, {0, 0, 1}};
  return std::make_unique<flight::SplineFlight>(waypoints, config, "test");
}

TEST(ImuIntegration, GivesBackAMinuteOfAggressiveFlight) {
  const EndError error = integrate(*aggressive_minute(), kMount, 4000, runge_kutta);
  EXPECT_LT(error.position_m, 1e-3);  // 8e-9 measured, the rounding error
  EXPECT_LT(error.angle_deg, 1e-4);   // 8e-11 measured
}

// The pieces of the spline join smoothly up to the second derivative of the rate and the third of
// the force. So a step across a joint causes an error of the order of h^4, and the number of joints
// is fixed: the fourth order holds over the whole flight. Measured at 200 Hz: midpoint 3.03 m and
// 0.032 deg, fourth order 0.18 mm and 2.1e-6 deg.
TEST(ImuIntegration, ConvergesAtTheMethodsOrder) {
  const auto flight = aggressive_minute();
  for (const auto& [method, order] :
       {std::pair<Method, double>{midpoint, 2.0}, {runge_kutta, 4.0}}) {
    EndError coarse = integrate(*flight, kMount, 100, method);
    for (const double rate : {200.0, 400.0, 800.0}) {
      const EndError fine = integrate(*flight, kMount, rate, method);
      // The next term of the error is smaller by (body rate * step)^2, about (5 rad/s / 50 Hz)^2.
      EXPECT_NEAR(std::log2(coarse.position_m / fine.position_m), order, 0.05) << rate << " Hz";
      EXPECT_NEAR(std::log2(coarse.angle_deg / fine.angle_deg), order, 0.05) << rate << " Hz";
      coarse = fine;
    }
  }
}

}  // namespace
}  // namespace lidarena::sensor
