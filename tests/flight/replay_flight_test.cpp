// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/replay_flight.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "lidarena/base/error.hpp"
#include "lidarena/base/random.hpp"
#include "lidarena/base/so3.hpp"
#include "lidarena/flight/recording.hpp"
#include "lidarena/flight/rotation_rates.hpp"
#include "lidarena/flight/spline_flight.hpp"
#include "tests/flight/flight_conformance.hpp"

namespace lidarena::flight {
namespace {

using Eigen::Vector3d;

const SplineFlight& original() {
  static const SplineFlight flight(
      std::vector<Vector3d>{{0, 0, 1}, {4, 0, 1}, {4, 3, 1.5}, {0, 3, 2}, {0, 0, 1}}, {}, "test");
  return flight;
}

Trajectory recorded(const Flight& flight, Time step) {
  std::vector<StampedPose> poses;
  const Time epoch = std::chrono::seconds(1'700'000'000);
  for (Time t{0}; t <= flight.duration(); t += step) {
    poses.push_back({epoch + t, flight.pose_at(t)});
  }
  return Trajectory(std::move(poses));
}

/// Poses at irregular instants with steps of up to 1 m and 1 rad.
Trajectory jagged() {
  SequentialRandom random(5);
  std::vector<StampedPose> poses;
  Pose pose = Pose::Identity();
  Time t{0};
  for (int i = 0; i < 40; ++i) {
    poses.push_back({t, pose});
    t += from_seconds(random.uniform(0.3, 0.6));
    const Vector3d step(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform());
    const Vector3d turn(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform());
    pose = pose * make_pose(so3::exp(turn), step);
  }
  return Trajectory(std::move(poses));
}

/// Maximum errors of a replay, also between the recorded instants, against the recorded motion.
struct ReplayError {
  double position = 0.0, rotation = 0.0, acceleration = 0.0, angular_acceleration = 0.0;
};

ReplayError replay_error(Time step) {
  const ReplayFlight replay(recorded(original(), step));
  ReplayError most;
  for (Time t{0}; t <= replay.duration(); t += std::chrono::microseconds(1711)) {
    const Motion a = original().at(t);
    const Motion b = replay.at(t);
    const auto raise = [](double& maximum, double value) { maximum = std::max(maximum, value); };
    raise(most.position, (a.world_from_body.inverse() * b.world_from_body).translation().norm());
    raise(most.rotation,
          so3::angle(a.world_from_body.linear().transpose() * b.world_from_body.linear()));
    raise(most.acceleration, (a.acceleration_world - b.acceleration_world).norm());
    raise(most.angular_acceleration,
          (a.angular_acceleration_body - b.angular_acceleration_body).norm());
  }
  return most;
}

TEST(ReplayFlight, StatedDerivativesAreThoseOfTheMotion) {
  conformance::expect_lawful(ReplayFlight(jagged()), 1);
  conformance::expect_lawful(ReplayFlight(recorded(original(), std::chrono::milliseconds(50))), 1);
}

TEST(ReplayFlight, PassesThroughEveryRecordedPoseAtItsInstant) {
  const Trajectory recording = jagged();
  const ReplayFlight replay(recording);
  for (const StampedPose& p : recording.poses()) {
    const Pose difference = p.world_from_body.inverse() * replay.pose_at(p.stamp);
    EXPECT_NEAR((difference.matrix() - Eigen::Matrix4d::Identity()).norm(), 0.0, 1e-13);
  }
  EXPECT_EQ(replay.duration(), recording.end_time() - recording.begin_time());
}

TEST(ReplayFlight, VelocityAndAccelerationAreContinuousAtRecordedPoses) {
  const Trajectory recording = jagged();
  const ReplayFlight replay(recording);
  for (std::size_t i = 1; i + 1 < recording.size(); ++i) {
    const Time t = recording.poses()[i].stamp;
    const Motion before = replay.at(t - Time{1});
    const Motion after = replay.at(t);
    // derivatives are up to 1e3 per s; over 1 ns that is 1e-6
    EXPECT_NEAR((before.velocity_world - after.velocity_world).norm(), 0.0, 1e-6);
    EXPECT_NEAR((before.acceleration_world - after.acceleration_world).norm(), 0.0, 1e-6);
    EXPECT_NEAR((before.angular_rate_body - after.angular_rate_body).norm(), 0.0, 1e-6);
    EXPECT_NEAR((before.angular_acceleration_body - after.angular_acceleration_body).norm(), 0.0,
                1e-6);
  }
}

TEST(ReplayFlight, FinerRecordingsConvergeToTheRecordedMotion) {
  const ReplayError coarse = replay_error(std::chrono::milliseconds(40));
  const ReplayError fine = replay_error(std::chrono::milliseconds(10));
  // The recorded position is five times continuously differentiable and the attitude three times:
  // the errors are O(h^5) and O(h^4), those of the accelerations O(h^3) and O(h^2). h is four times
  // smaller; 25 % are allowed for higher-order terms.
  EXPECT_LT(fine.position, coarse.position / (0.75 * 1024.0));
  EXPECT_LT(fine.rotation, coarse.rotation / (0.75 * 256.0));
  EXPECT_LT(fine.acceleration, coarse.acceleration / (0.75 * 64.0));
  EXPECT_LT(fine.angular_acceleration, coarse.angular_acceleration / (0.75 * 16.0));
}

TEST(ReplayFlight, ConstantVelocityAndRateAreReproducedExactly) {
  std::vector<StampedPose> poses;
  const Vector3d velocity(1.0, -2.0, 0.5);
  const Vector3d rate(0.3, -0.8, 1.1);
  const auto pose = [&](double t) { return make_pose(so3::exp(rate * t), velocity * t); };
  for (const double t : {0.0, 0.1, 0.35, 0.4, 0.7, 1.0}) {
    poses.push_back({from_seconds(t), pose(t)});
  }
  const ReplayFlight replay{Trajectory(poses)};
  for (double t = 0.0; t <= 1.0; t += 0.013) {
    const Motion m = replay.at(from_seconds(t));
    EXPECT_NEAR((m.world_from_body.matrix() - pose(t).matrix()).norm(), 0.0, 1e-12);
    EXPECT_NEAR((m.velocity_world - velocity).norm(), 0.0, 1e-11);
    EXPECT_NEAR((m.angular_rate_body - rate).norm(), 0.0, 1e-11);
    EXPECT_NEAR(m.acceleration_world.norm(), 0.0, 1e-10);
    EXPECT_NEAR(m.angular_acceleration_body.norm(), 0.0, 1e-10);
  }
}

TEST(ReplayFlight, AMovedRecordingGivesTheMovedFlight) {
  const Pose moved = make_pose(so3::exp(Vector3d(0.1, 0.2, 1.0)), Vector3d(5, -3, 2));
  const ReplayFlight here(jagged());
  const ReplayFlight there(placed(jagged(), moved, Pose::Identity()));
  for (Time t{0}; t < here.duration(); t += std::chrono::milliseconds(17)) {
    const Motion a = here.at(t);
    const Motion b = there.at(t);
    EXPECT_NEAR(((moved * a.world_from_body).matrix() - b.world_from_body.matrix()).norm(), 0.0,
                1e-12);
    EXPECT_NEAR((moved.linear() * a.velocity_world - b.velocity_world).norm(), 0.0, 1e-11);
    EXPECT_NEAR((a.angular_rate_body - b.angular_rate_body).norm(), 0.0, 1e-11);
  }
}

TEST(ReplayFlight, ThinningKeepsPosesAtLeastAStepApartAndQuietensTheRates) {
  // 0.2 mm of noise at 100 Hz is 0.0002 * 3 / 0.01^2 = 6 m/s^2; at 10 Hz a hundredth of that
  SequentialRandom random(9);
  std::vector<StampedPose> poses;
  for (int i = 0; i < 500; ++i) {
    const Vector3d noise(random.normal(), random.normal(), random.normal());
    poses.push_back({i * std::chrono::milliseconds(10),
                     make_pose(Eigen::Matrix3d(Eigen::Matrix3d::Identity()), 2e-4 * noise)});
  }
  const Trajectory recording(std::move(poses));
  const Trajectory sparse = thinned(recording, 0.1);
  EXPECT_EQ(sparse.size(), 50U);
  const auto rms = [](const Flight& flight) {
    double sum = 0.0;
    int count = 0;
    for (Time t{0}; t < flight.duration(); t += std::chrono::microseconds(3137), ++count) {
      sum += flight.at(t).acceleration_world.squaredNorm() / 3.0;
    }
    return std::sqrt(sum / count);
  };
  EXPECT_NEAR(rms(ReplayFlight(recording)) / rms(ReplayFlight(sparse)), 100.0, 30.0);
  EXPECT_EQ(thinned(recording, 0.0).size(), recording.size());
}

TEST(ReplayFlight, TwoPosesAreJoinedByASteadyMotionAndOneIsRefused) {
  std::vector<StampedPose> poses{{Time{0}, Pose::Identity()}};
  EXPECT_THROW(ReplayFlight{Trajectory(poses)}, InputError);
  EXPECT_THROW(ReplayFlight{Trajectory{}}, InputError);
  poses.push_back({from_seconds(2.0), make_pose(so3::exp(Vector3d(0, 0, 1)), Vector3d(4, 0, 0))});
  const ReplayFlight flight{Trajectory(poses)};
  const Motion middle = flight.at(from_seconds(1.0));
  EXPECT_NEAR((middle.world_from_body.translation() - Vector3d(2, 0, 0)).norm(), 0.0, 1e-14);
  EXPECT_NEAR((middle.angular_rate_body - Vector3d(0, 0, 0.5)).norm(), 0.0, 1e-14);
}

TEST(RotationRates, AgreeWithNumericDerivativesForSmallAndLargeRotations) {
  SequentialRandom random(11);
  for (const double size : {0.0, 1e-6, 1e-3, 0.0999, 0.1001, 0.5, 2.0, 3.1, 5.0}) {
    Vector3d v0(random.normal(), random.normal(), random.normal());
    v0 *= size / v0.norm();
    const Vector3d v1(random.normal(), random.normal(), random.normal());
    const Vector3d v2(random.normal(), random.normal(), random.normal());
    const auto v = [&](double t) -> Vector3d { return v0 + t * v1 + 0.5 * t * t * v2; };
    const auto dv = [&](double t) -> Vector3d { return v1 + t * v2; };
    const double h = 1e-4;
    const Vector3d rate = so3::log(so3::exp(v(-h)).transpose() * so3::exp(v(h))) / (2.0 * h);
    const Vector3d gain = (body_rate(v(h), dv(h)) - body_rate(v(-h), dv(-h))) / (2.0 * h);
    // h^2 / 6 times third derivatives of the order of 100, and rounding 1e-15 / h
    EXPECT_NEAR((body_rate(v0, v1) - rate).norm(), 0.0, 3e-7) << size;
    EXPECT_NEAR((body_acceleration(v0, v1, v2) - gain).norm(), 0.0, 3e-7) << size;
  }
}

}  // namespace
}  // namespace lidarena::flight
