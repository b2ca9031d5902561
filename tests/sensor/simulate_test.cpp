// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/simulate.hpp"

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "tests/sensor/flights.hpp"
#include "tests/sensor/worlds.hpp"

namespace lidarena::sensor {
namespace {

using namespace testing;
using namespace world::testing;

const world::World& box_world() {
  static const world::World world(box_mesh({-9, -8, -3}, {7, 6, 5}));
  return world;
}

SensorConfig with_imu(SensorConfig sensor, double rate_hz) {
  sensor.range_noise_m = 0.02;
  sensor.imu.emplace();
  sensor.imu->rate_hz = rate_hz;
  sensor.imu->gyro_noise_density = 1e-4;
  sensor.imu->accel_noise_density = 1e-3;
  sensor.imu->lidar_from_imu.translation() = Eigen::Vector3d(0.01, 0.02, -0.04);
  return sensor;
}

std::vector<Event> fly(const std::vector<SensorConfig>& sensors, double seconds, int threads = 1,
                       const SimulationOptions& options = {}) {
  const SwingingFlight flight(seconds);
  const Parallel parallel(threads);
  const auto source = simulate(box_world(), flight, sensors, options, parallel);
  std::vector<Event> events;
  while (auto event = source->next()) events.push_back(std::move(*event));
  EXPECT_FALSE(source->next().has_value());  // no events after the end
  return events;
}

const ImuSample* imu_of(const Event& event) { return std::get_if<ImuSample>(&event.data); }
const Scan* scan_of(const Event& event) { return std::get_if<Scan>(&event.data); }

bool same_event(const Event& a, const Event& b) {
  if (a.sensor_id != b.sensor_id || a.data.index() != b.data.index()) return false;
  if (const ImuSample* imu = imu_of(a)) {
    const ImuSample* other = imu_of(b);
    return imu->stamp == other->stamp && imu->gyro == other->gyro && imu->accel == other->accel;
  }
  return same(*scan_of(a), *scan_of(b));
}

/// Checks that IMU samples are ordered by time, the scans of each sensor are ordered by time, and a
/// scan comes only after every IMU has delivered its samples up to the scan's last point and one at
/// or after it, if the flight is long enough. `imu_rates`: of each sensor, Hz; `seconds`: duration
/// of the flight.
void expect_promised_order(const std::vector<Event>& events,
                           const std::map<std::string, double>& imu_rates, double seconds) {
  std::map<std::string, Time> newest_imu;
  std::map<std::string, Time> newest_scan_end;
  Time clock{0};
  for (const Event& event : events) {
    if (const ImuSample* imu = imu_of(event)) {
      EXPECT_GE(imu->stamp, clock);
      clock = newest_imu[event.sensor_id] = imu->stamp;
      for (const auto& [id, end] : newest_scan_end) EXPECT_GT(imu->stamp, end) << id;
      continue;
    }
    const Time end = end_of(*scan_of(event));
    EXPECT_GT(end, newest_scan_end[event.sensor_id]);
    newest_scan_end[event.sensor_id] = end;
    for (const auto& [id, rate] : imu_rates) {
      const bool was_its_last = to_seconds(newest_imu[id]) + 1.0 / rate > seconds;
      EXPECT_TRUE(newest_imu[id] >= end || was_its_last) << id;
    }
  }
}

TEST(Simulate, DeliversInTheOrderThatEventSourcePromises) {
  const std::vector<SensorConfig> sensors{with_imu(mid360(), 200), with_imu(ouster(), 133)};
  const auto events = fly(sensors, 0.55);
  expect_promised_order(events, {{"mid360", 200}, {"ouster", 133}}, 0.55);
  std::map<std::pair<std::string, bool>, int> counts;
  for (const Event& event : events) ++counts[{event.sensor_id, scan_of(event) != nullptr}];
  EXPECT_EQ((counts[{"mid360", false}]), 111);  // 0, 5, ... 550 ms
  EXPECT_EQ((counts[{"ouster", false}]), 74);   // 0 ... 73 / 133 Hz = 0.549 s
  EXPECT_EQ((counts[{"mid360", true}]), 5);     // only complete scans
  EXPECT_EQ((counts[{"ouster", true}]), 5);
}

TEST(Simulate, SensorsWithoutAnImuGiveScansAlone) {
  const auto events = fly({mid360()}, 0.3);
  ASSERT_EQ(events.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    ASSERT_NE(scan_of(events[i]), nullptr);
    EXPECT_EQ(scan_of(events[i])->stamp, std::chrono::milliseconds(100 * i));
  }
}

TEST(Simulate, IsTheSameOnAnyNumberOfThreadsAndDiffersBySeed) {
  const std::vector<SensorConfig> sensors{with_imu(mid360(), 200), with_imu(ouster(), 100)};
  const auto events = fly(sensors, 0.2, 1);
  for (const int threads : {2, 5}) {
    const auto again = fly(sensors, 0.2, threads);
    EXPECT_TRUE(std::equal(events.begin(), events.end(), again.begin(), again.end(), same_event));
  }
  SimulationOptions other;
  other.seed = 2;
  EXPECT_FALSE(same_event(fly(sensors, 0.2, 1, other).front(), events.front()));
}

TEST(Simulate, ASensorMeasuresTheSameAloneAndInCompany) {
  const auto alone = fly({with_imu(mid360(), 200)}, 0.2);
  std::vector<Event> in_company;
  for (Event& event : fly({with_imu(ouster(), 100), with_imu(mid360(), 200)}, 0.2)) {
    if (event.sensor_id == "mid360") in_company.push_back(std::move(event));
  }
  EXPECT_TRUE(
      std::equal(alone.begin(), alone.end(), in_company.begin(), in_company.end(), same_event));
}

TEST(Simulate, DurationCutsTheFlightAndNoiseCanBeSwitchedOff) {
  SimulationOptions options;
  options.duration = from_seconds(0.25);
  options.noise = false;
  const SensorConfig sensor = with_imu(mid360(), 200);
  const auto events = fly({sensor}, 10.0, 1, options);
  EXPECT_EQ(events.size(), 51U + 2U);
  const SwingingFlight flight(10.0);
  for (const Event& event : events) {
    if (const Scan* scan = scan_of(event)) {
      for (const Point& point : scan->points) {
        const Pose pose = flight.pose_at(time_of(*scan, point)) * sensor.body_from_lidar;
        ASSERT_LT(distance_to_box({-9, -8, -3}, {7, 6, 5}, pose * point.position.cast<double>()),
                  1e-4);
      }
    } else {
      const double rate = flight.at(imu_of(event)->stamp).angular_rate_body.norm();
      EXPECT_NEAR(imu_of(event)->gyro.norm(), rate, 1e-12);
    }
  }
}

struct TruthRecorder : ScanTruthSink {
  std::vector<ScanTruth> scans;
  void write(const ScanTruth& truth) override { scans.push_back(truth); }
};

TEST(Simulate, TheTruthOfEveryScanComesJustBeforeIt) {
  const SwingingFlight flight(0.3);
  const std::vector<SensorConfig> sensors{with_imu(mid360(), 200), with_imu(ouster(), 100)};
  TruthRecorder recorder;
  SimulationOptions options;
  options.truth = &recorder;
  const auto source = simulate(box_world(), flight, sensors, options, Parallel(2));
  std::size_t scans = 0;
  while (const auto event = source->next()) {
    const Scan* scan = scan_of(*event);
    if (scan == nullptr) continue;
    ASSERT_EQ(recorder.scans.size(), ++scans);
    EXPECT_EQ(recorder.scans.back().sensor_id, event->sensor_id);
    EXPECT_EQ(recorder.scans.back().stamp, scan->stamp);
    EXPECT_EQ(recorder.scans.back().points.size(), scan->points.size());
  }
  EXPECT_EQ(scans, 6U);
  // Recording the truth does not change the events.
  const auto watched = fly(sensors, 0.3, 1, options);
  const auto unwatched = fly(sensors, 0.3);
  EXPECT_TRUE(
      std::equal(watched.begin(), watched.end(), unwatched.begin(), unwatched.end(), same_event));
}

TEST(Simulate, TheRigDescribesWhatIsMounted) {
  const SensorConfig sensor = with_imu(mid360(), 200);
  const Rig rig = make_rig({sensor, ouster(1024), sensor});
  ASSERT_EQ(rig.lidars.size(), 3U);
  ASSERT_EQ(rig.imus.size(), 2U);
  EXPECT_EQ(rig.lidars[0].id, "mid360");
  EXPECT_EQ(rig.lidars[1].id, "ouster");
  EXPECT_EQ(rig.lidars[2].id, "mid360_2");
  EXPECT_EQ(rig.imus[1].id, "mid360_2");
  EXPECT_EQ(rig.lidars[0].kind, "rosette");
  EXPECT_EQ(rig.lidars[0].model, "livox_mid360");
  EXPECT_EQ(rig.lidars[0].rows, 4);
  EXPECT_EQ(rig.lidars[0].columns, 5000);
  EXPECT_EQ(rig.lidars[1].kind, "spinning");
  EXPECT_EQ(rig.lidars[1].rows, 128);
  EXPECT_EQ(rig.lidars[1].columns, 1024);
  EXPECT_TRUE(rig.lidars[0].body_from_lidar.isApprox(sensor.body_from_lidar));
  EXPECT_TRUE(
      rig.imus[0].body_from_imu.isApprox(sensor.body_from_lidar * sensor.imu->lidar_from_imu));
  EXPECT_EQ(rig.imus[0].gyro_noise_density, sensor.imu->gyro_noise_density);
}

TEST(Simulate, TwinSensorsSeeTheSameSceneWithNoiseOfTheirOwn) {
  const auto events = fly({with_imu(mid360(), 200), with_imu(mid360(), 200)}, 0.1);
  const Scan& first = *scan_of(events[events.size() - 2]);
  const Scan& second = *scan_of(events.back());
  EXPECT_NE(events[events.size() - 2].sensor_id, events.back().sensor_id);
  ASSERT_EQ(first.points.size(), second.points.size());
  double squares = 0.0;
  for (std::size_t i = 0; i < first.points.size(); ++i) {
    squares += (first.points[i].position - second.points[i].position).squaredNorm();
  }
  const auto n = static_cast<double>(first.points.size());
  const double sigma = 0.02 * std::sqrt(2.0);  // of the difference of two independent errors
  EXPECT_NEAR(std::sqrt(squares / n), sigma, 4 * sigma / std::sqrt(2 * n));
}

}  // namespace
}  // namespace lidarena::sensor
