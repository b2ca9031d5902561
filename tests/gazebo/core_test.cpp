// SPDX-License-Identifier: BSD-3-Clause
// Tests the core of the Gazebo plugin without Gazebo.
#include <gtest/gtest.h>

#include "lidarena/sensor/stepped_sensor.hpp"
#include "lidarena/world/moving_world.hpp"
#include "lidarena/world/primitives.hpp"

namespace lidarena {
namespace {

TEST(GazeboCore, ASensorSeesABallFallAsPhysicsHasIt) {
  constexpr double kRadius = 1.5, kHeight = 10.0, kGravityHere = 9.80665;
  constexpr Time kStep{1'000'000};
  sensor::SensorConfig config;
  config.name = "mid360";
  config.imu = sensor::ImuConfig{};
  sensor::SteppedSensor sensor(config, config.name, 1, true, Time{0});
  world::MovingWorld world(
      {{world::make_sphere(kRadius), Pose::Identity(), {}, true},
       {world::make_plane(), make_pose(Eigen::Quaterniond::Identity(), {0, 0, -1}), {}, false}});
  const auto height_at = [&](Time t) {
    const double s = to_seconds(t);
    return kHeight - 0.5 * kGravityHere * s * s;
  };
  std::vector<Event> events;
  for (Time t{0}; t <= 1000 * kStep; t += kStep) {
    const Pose pose = make_pose(Eigen::Quaterniond::Identity(), {12, 0, height_at(t)});
    world.move({&pose, 1});
    sensor.step(world, {t, Pose::Identity()}, events);
  }
  std::size_t on_ball = 0, scans = 0, samples = 0;
  for (const Event& event : events) {
    const auto* scan = std::get_if<Scan>(&event.data);
    samples += scan == nullptr;
    if (scan == nullptr) continue;
    ++scans;
    for (const Point& point : scan->points) {
      if (point.position.z() < -0.999F) continue;  // the ground
      ++on_ball;
      // the ball is seen where it is at the end of the shot's step
      const Time shot = scan->stamp + Time{point.dt_ns};
      const Time end = std::max((shot + kStep - Time{1}) / kStep, std::int64_t{1}) * kStep;
      const Eigen::Vector3d middle(12, 0, height_at(end));
      ASSERT_NEAR((point.position.cast<double>() - middle).norm(), kRadius, 1e-5);
    }
  }
  EXPECT_EQ(scans, 9U);  // the tenth scan still waits for an IMU sample after the last step
  EXPECT_EQ(samples, 200U);
  EXPECT_GT(on_ball, 50U);
}

}  // namespace
}  // namespace lidarena
