// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/recorded_imu_reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lidarena/base/error.hpp"
#include "lidarena/base/so3.hpp"
#include "lidarena/sensor/simulate.hpp"
#include "tests/sensor/flights.hpp"
#include "tests/sensor/worlds.hpp"

namespace lidarena::sensor {
namespace {

using namespace testing;
using namespace world::testing;
using Eigen::Vector3d;

constexpr Time kStep = std::chrono::milliseconds(10);

/// A flight of one second with an IMU whose axes are those of the body, turned about x.
class RecordedFlight final : public SwingingFlight {
 public:
  RecordedFlight() : SwingingFlight(1.0) {
    imu_.body_from_imu = make_pose(so3::exp({M_PI / 2, 0, 0}), {0, 0, 0});
    for (int i = 0; i <= 95; ++i)  // ends before the flight
      imu_.samples.push_back({i * kStep, Vector3d(i, 0, 1), Vector3d(0, i, 2)});
  }
  const flight::RecordedImu* recorded_imu() const override { return &imu_; }

 private:
  flight::RecordedImu imu_;
};

SensorConfig sensor_at(const Vector3d& lidar_from_imu) {
  SensorConfig sensor;
  sensor.name = "lidar";
  sensor.imu.emplace();
  sensor.imu->gyro_noise_density = 1.0;  // of a simulated IMU
  sensor.imu->lidar_from_imu.translation() = lidar_from_imu;
  return sensor;
}

TEST(RecordedImu, ItsSamplesAreDeliveredInTheAxesOfTheRig) {
  const world::World world(box_mesh({-9, -8, -3}, {7, 6, 5}));
  const RecordedFlight flight;
  const auto source = simulate(world, flight, {sensor_at({0, 0, 0})}, {}, Parallel(1));
  std::vector<ImuSample> samples;
  std::size_t scans = 0;
  while (auto event = source->next()) {
    if (const auto* sample = std::get_if<ImuSample>(&event->data))
      samples.push_back(*sample);
    else
      ++scans;
  }
  EXPECT_EQ(scans, 10);  // also the last one, which no sample follows
  ASSERT_EQ(samples.size(), 96);
  for (int i = 0; i <= 95; ++i) {
    const ImuSample& sample = samples[static_cast<std::size_t>(i)];
    EXPECT_EQ(sample.stamp, i * kStep);
    EXPECT_LT((sample.gyro - Vector3d(i, -1, 0)).norm(), 1e-12);  // a quarter turn about x
    EXPECT_LT((sample.accel - Vector3d(0, -2, i)).norm(), 1e-12);
  }
}

TEST(RecordedImu, WithoutNoiseTheImuIsSimulated) {
  const world::World world(box_mesh({-9, -8, -3}, {7, 6, 5}));
  const RecordedFlight flight;
  SimulationOptions options;
  options.noise = false;
  const auto source = simulate(world, flight, {sensor_at({0, 0, 0})}, options, Parallel(1));
  const auto first = source->next();
  ASSERT_TRUE(first);
  EXPECT_NEAR(std::get<ImuSample>(first->data).accel.norm(), 9.8, 5.0);
}

TEST(RecordedImu, AnImuInAnotherPlaceIsRefused) {
  const RecordedFlight flight;
  try {
    RecordedImuReader(*flight.recorded_imu(), make_pose(Eigen::Matrix3d::Identity(), {0.01, 0, 0}),
                      "mid360");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(),
                AllOf(HasSubstr("mid360"), HasSubstr("(0.01 "), HasSubstr("lidar_from_imu")));
  }
}

}  // namespace
}  // namespace lidarena::sensor
