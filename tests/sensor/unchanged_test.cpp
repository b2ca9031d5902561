// SPDX-License-Identifier: BSD-3-Clause
// Measurements of shipped sensors, compared with those that were recorded before sensors had the
// errors of error_config.hpp: an error that is off draws nothing and moves nothing.
#include <gtest/gtest.h>

#include <array>

#include "lidarena/sensor/simulate.hpp"
#include "tests/sensor/flights.hpp"
#include "tests/sensor/shipped.hpp"
#include "tests/sensor/worlds.hpp"

namespace lidarena::sensor {
namespace {

using namespace testing;
using namespace world::testing;

/// Weighted sums over all measurements; the weights depend on the place in the recording.
struct Sums {
  double points = 0.0, intensities = 0.0, times = 0.0, gyro = 0.0, accel = 0.0;
  std::size_t count = 0;
};

Sums sums_of(EventSource& source) {
  Sums sums;
  while (const auto event = source.next()) {
    if (const auto* imu = std::get_if<ImuSample>(&event->data)) {
      const double weight = 1.0 + 1e-3 * static_cast<double>(imu->stamp.count() % 1009);
      sums.gyro += weight * imu->gyro.dot(Eigen::Vector3d(1, 2, 3));
      sums.accel += weight * imu->accel.dot(Eigen::Vector3d(1, 2, 3));
      continue;
    }
    const Scan& scan = std::get<Scan>(event->data);
    for (const Point& point : scan.points) {
      const double weight = 1.0 + 1e-3 * static_cast<double>(++sums.count % 1009);
      sums.points += weight * point.position.cast<double>().dot(Eigen::Vector3d(1, 2, 3));
      sums.intensities += static_cast<double>(point.intensity);
      sums.times += 1e-9 * static_cast<double>((scan.stamp + Time{point.dt_ns}).count());
    }
  }
  return sums;
}

Sums measured(const std::string& sensor, bool noise) {
  const world::World room(box_mesh({-9, -7, -4}, {8, 6, 3}), "room", world::RayCaster::kBvh);
  const SwingingFlight flight(0.31);
  SimulationOptions options;
  options.seed = 5;
  options.noise = noise;
  const auto source =
      simulate(room, flight, {load_sensor(kConfigs / (sensor + ".yaml"))}, options, kOneThread);
  return sums_of(*source);
}

struct Recorded {
  const char* sensor;
  bool noise;
  Sums sums;
};

TEST(Unchanged, SensorsWithoutTheNewErrorsMeasureWhatTheyMeasuredBefore) {
  const std::array recorded{
      Recorded{"livox_mid360",
               true,
               {613815.311885, 5457292.24455, 8999.85, 286.764204696, 1297.35321046, 60000}},
      Recorded{"livox_mid360_vibrating",
               true,
               {613832.52997, 5457292.24455, 8999.85, 279.43595821, 1220.21134431, 60000}},
      Recorded{
          "ouster_os0_128_512",
          true,
          {-578713.528158, 18671318.4662, 29472.0000491, 148.749036286, 683.046476568, 196608}},
      Recorded{"livox_mid360_vibrating",
               false,
               {613854.721541, 5457292.24455, 8999.85, 286.237096519, 1315.48342637, 60000}},
  };
  for (const auto& [sensor, noise, sums] : recorded) {
    SCOPED_TRACE(sensor);
    const Sums now = measured(sensor, noise);
    EXPECT_EQ(now.count, sums.count);
    // Relative 1e-8: below the effect of any other draw, above the rounding of another compiler.
    EXPECT_NEAR(now.points / sums.points, 1.0, 1e-8);
    EXPECT_NEAR(now.intensities / sums.intensities, 1.0, 1e-8);
    EXPECT_NEAR(now.times / sums.times, 1.0, 1e-8);
    EXPECT_NEAR(now.gyro / sums.gyro, 1.0, 1e-8);
    EXPECT_NEAR(now.accel / sums.accel, 1.0, 1e-8);
  }
}

}  // namespace
}  // namespace lidarena::sensor
