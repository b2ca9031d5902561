// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/stepped_sensor.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "lidarena/sensor/simulate.hpp"
#include "lidarena/sensor/step_flight.hpp"
#include "lidarena/world/moving_world.hpp"
#include "lidarena/world/primitives.hpp"
#include "tests/sensor/flights.hpp"
#include "tests/sensor/worlds.hpp"

namespace lidarena::sensor {
namespace {

using Eigen::Vector3d;
using namespace testing;
using namespace world::testing;

constexpr Time kStep{1'000'000};

world::World small_room() {
  return world::World(box_mesh({-9, -7, -4}, {8, 6, 3}), "room", world::RayCaster::kBvh);
}

ImuConfig noisy_imu() {
  ImuConfig imu;
  imu.gyro_noise_density = 1e-4;
  imu.accel_noise_density = 1e-3;
  imu.gyro_bias_walk = 1e-5;
  imu.accel_turn_on_bias = 0.1;
  imu.lidar_from_imu = make_pose(Eigen::Quaterniond::Identity(), {0.01, 0.02, -0.04});
  return imu;
}

/// Steps the sensor like a physics engine that moves the body along `flight`.
std::vector<Event> fly_by_steps(SteppedSensor& sensor, const world::Surfaces& world,
                                const flight::Flight& flight, Time from, Time to) {
  std::vector<Event> events;
  for (Time t = from; t <= to; t += kStep) sensor.step(world, {t, flight.pose_at(t)}, events);
  return events;
}

std::vector<Event> all_of(EventSource& source) {
  std::vector<Event> events;
  while (auto event = source.next()) events.push_back(std::move(*event));
  return events;
}

/// `max_difference`: maximum difference of points, m.
void expect_same_scan(const Scan& a, const Scan& b, double max_difference) {
  EXPECT_EQ(a.stamp, b.stamp);
  EXPECT_EQ(a.timed, b.timed);
  ASSERT_EQ(a.points.size(), b.points.size());
  for (std::size_t i = 0; i < a.points.size(); ++i) {
    const Point &p = a.points[i], &q = b.points[i];
    ASSERT_LT((p.position - q.position).norm(), max_difference) << i;
    EXPECT_NEAR(p.intensity, q.intensity, 1e-2);
    EXPECT_EQ(p.dt_ns, q.dt_ns);
    EXPECT_EQ(p.ring, q.ring);
    EXPECT_EQ(p.echo, q.echo);
  }
}

TEST(SteppedSensor, StepsGiveTheEventsOfTheSimulationInItsOrder) {
  const world::World world = small_room();
  const SwingingFlight flight(0.6);
  for (SensorConfig config : {mid360(), ouster()}) {
    config.range_noise_m = 0.02;
    config.imu = noisy_imu();
    const auto source = simulate(world, flight, {config}, {.seed = 7}, Parallel(1));
    const std::vector<Event> expected = all_of(*source);
    SteppedSensor sensor(config, config.name, 7, true, Time{0});
    // one step more, since IMU samples come one step late
    const std::vector<Event> events =
        fly_by_steps(sensor, world, flight, Time{0}, flight.duration() + kStep);
    ASSERT_EQ(events.size(), expected.size());
    for (std::size_t i = 0; i < events.size(); ++i) {
      ASSERT_EQ(events[i].sensor_id, expected[i].sensor_id);
      ASSERT_EQ(events[i].data.index(), expected[i].data.index()) << i;
      if (const auto* scan = std::get_if<Scan>(&events[i].data)) {
        // Linear interpolation between steps: error a h^2 / 8 = 1.2e-6 m here; same for rotation,
        // times 12 m.
        expect_same_scan(*scan, std::get<Scan>(expected[i].data), 2e-5);
        continue;
      }
      const auto& sample = std::get<ImuSample>(events[i].data);
      const auto& other = std::get<ImuSample>(expected[i].data);
      EXPECT_EQ(sample.stamp, other.stamp);
      // the first instant is at the edge of its parabola: error of a third derivative times h
      const double max_difference = sample.stamp == Time{0} ? 2e-2 : 1e-5;
      EXPECT_LT((sample.gyro - other.gyro).norm(), max_difference) << to_seconds(sample.stamp);
      EXPECT_LT((sample.accel - other.accel).norm(), max_difference) << to_seconds(sample.stamp);
    }
  }
}

TEST(SteppedSensor, FrozenScansAreThoseOfTheSimulation) {
  const world::World world = small_room();
  const SwingingFlight flight(0.4);
  for (const ScanMode mode : {ScanMode::kFrozen, ScanMode::kFrozenUnstamped, ScanMode::kFrozenRamp,
                              ScanMode::kOfficial}) {
    SensorConfig config = mid360();
    config.mode = mode;
    const Lidar lidar = make_lidar(config, 1);
    SteppedSensor sensor(config, config.name, 1, true, Time{0});
    const auto events = fly_by_steps(sensor, world, flight, Time{0}, flight.duration());
    ASSERT_EQ(events.size(), 4U);
    for (std::size_t i = 0; i < 4; ++i) {
      expect_same_scan(std::get<Scan>(events[i].data), lidar.measure(world, flight, i, Parallel(1)),
                       1e-5);
    }
  }
}

TEST(SteppedSensor, EachShotSeesAMovingWallWhereItsStepPutsIt) {
  SensorConfig config = mid360();
  config.body_from_lidar = Pose::Identity();
  SteppedSensor sensor(config, "lidar", 1, true, Time{0});
  constexpr double kSpeed = 20.0;
  const auto wall_at = [](Time t) { return 10.0 + kSpeed * to_seconds(t); };
  world::MovingWorld world(
      {{world::make_mesh(world::box_shape({2.0, 100.0, 100.0})), Pose::Identity(), {}, true}});
  std::vector<Event> events;
  for (Time t{0}; t <= 100 * kStep; t += kStep) {
    const Pose pose = make_pose(Eigen::Quaterniond::Identity(), {wall_at(t) + 1.0, 0, 0});
    world.move({&pose, 1});
    sensor.step(world, {t, Pose::Identity()}, events);
  }
  ASSERT_EQ(events.size(), 1U);
  const Scan& scan = std::get<Scan>(events[0].data);
  EXPECT_GT(scan.points.size(), 4000U);
  for (const Point& point : scan.points) {
    const auto steps = (point.dt_ns + kStep.count() - 1) / kStep.count();
    const Time step_end = std::max<std::int64_t>(steps, 1) * kStep;
    ASSERT_NEAR(point.position.x(), wall_at(step_end), 1e-4) << point.dt_ns;
  }
}

TEST(SteppedSensor, BegunLateItsScansAreThoseOfOneThatWasThereAllTheTime) {
  const world::World world = small_room();
  const SwingingFlight flight(1.0);
  SensorConfig config = mid360();
  config.range_noise_m = 0.02;
  config.imu = noisy_imu();
  SteppedSensor sensor(config, config.name, 3, true, 333 * kStep);
  const auto events = fly_by_steps(sensor, world, flight, 333 * kStep, 620 * kStep);
  const Lidar lidar(config, make_pattern(config), config.name, 3, true);
  std::vector<Scan> scans;
  for (const Event& event : events) {
    if (const auto* scan = std::get_if<Scan>(&event.data)) scans.push_back(*scan);
  }
  ASSERT_EQ(scans.size(), 2U);  // from 0.4 s and from 0.5 s
  expect_same_scan(scans[0], lidar.measure(world, flight, 4, Parallel(1)), 2e-5);
  expect_same_scan(scans[1], lidar.measure(world, flight, 5, Parallel(1)), 2e-5);
  EXPECT_EQ(std::get<ImuSample>(events[0].data).stamp, Time{335'000'000});
}

TEST(SteppedSensor, WhenTimeGoesBackItStartsAnew) {
  const world::World world = small_room();
  const SwingingFlight flight(1.0);
  SteppedSensor sensor(mid360(), "a", 1, true, Time{0});
  const auto first = fly_by_steps(sensor, world, flight, Time{0}, 250 * kStep);
  const auto again = fly_by_steps(sensor, world, flight, Time{0}, 250 * kStep);
  ASSERT_EQ(first.size(), 2U);
  ASSERT_EQ(again.size(), 2U);
  EXPECT_TRUE(same(std::get<Scan>(first[1].data), std::get<Scan>(again[1].data)));
}

TEST(StepFlight, IsExactForConstantAccelerationAndRate) {
  const Vector3d a(1, -2, 3), v(4, 5, -6), p(7, 8, 9), rate(0.3, -0.8, 1.2);
  const Pose start = tilted_pose(p, 0.4, -0.3, 0.2);
  const auto at = [&](double t) {
    return make_pose(
        Eigen::Matrix3d(start.linear() *
                        Eigen::AngleAxisd(rate.norm() * t, rate.normalized()).toRotationMatrix()),
        p + t * v + 0.5 * t * t * a);
  };
  const StepFlight flight(
      {StampedPose{Time{0}, at(0.0)}, {Time{1'000'000}, at(0.001)}, {Time{3'000'000}, at(0.003)}});
  for (const double t : {0.0, 0.001, 0.0022, 0.003}) {
    const flight::Motion motion = flight.at(from_seconds(t));
    EXPECT_LT((motion.world_from_body.matrix() - at(t).matrix()).norm(), 1e-12);
    EXPECT_LT((motion.velocity_world - (v + t * a)).norm(), 1e-9);
    EXPECT_LT((motion.acceleration_world - a).norm(), 1e-6);
    EXPECT_LT((motion.angular_rate_body - rate).norm(), 1e-9);
    EXPECT_LT(motion.angular_acceleration_body.norm(), 1e-6);
  }
}

}  // namespace
}  // namespace lidarena::sensor
