// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/stages/split_sweeps.hpp"

#include <gtest/gtest.h>

#include <map>
#include <vector>

#include "lidarena/base/error.hpp"
#include "lidarena/stages/scene_settings.hpp"
#include "tests/listed_sources.hpp"

namespace lidarena::stages {
namespace {

using std::chrono::milliseconds;

Event imu(int ms) {
  ImuSample sample;
  sample.stamp = milliseconds(ms);
  return {"imu", sample};
}

/// A sweep of 100 ms with a point every millisecond.
Event sweep(int ms, const char* id = "lidar") {
  Scan scan;
  scan.stamp = milliseconds(ms);
  for (int i = 0; i < 100; ++i) {
    Point point;
    point.position = {static_cast<float>(ms + i), 0.0F, 0.0F};
    point.dt_ns = i * 1'000'000;
    scan.points.push_back(point);
  }
  return {id, scan};
}

std::vector<Event> recording() {
  std::vector<Event> events;
  for (int ms = 0; ms <= 200; ms += 5) {
    events.push_back(imu(ms));
    if (ms == 100 || ms == 200) events.push_back(sweep(ms - 100));
  }
  return events;
}

std::vector<Event> all_of(EventSource& source) {
  std::vector<Event> events;
  while (auto event = source.next()) events.push_back(std::move(*event));
  return events;
}

TEST(SplitSweeps, LosesAndMovesNoPointAndNoSample) {
  SplitSweeps source(std::make_unique<listed::Events>(recording()), "lidar", 3);
  std::vector<float> positions;
  std::size_t samples = 0, scans = 0;
  for (const Event& event : all_of(source)) {
    const auto* scan = std::get_if<Scan>(&event.data);
    if (scan == nullptr) {
      ++samples;
      continue;
    }
    ++scans;
    EXPECT_EQ(scan->points.front().dt_ns, 0) << "a stamp is that of the first point";
    for (const Point& point : scan->points) {
      EXPECT_EQ(time_of(*scan, point), milliseconds(static_cast<int>(point.position.x())));
      positions.push_back(point.position.x());
    }
  }
  EXPECT_EQ(samples, 41U);
  EXPECT_EQ(scans, 6U);
  ASSERT_EQ(positions.size(), 200U);
  for (std::size_t i = 0; i < 200; ++i) EXPECT_EQ(positions[i], static_cast<float>(i));
}

TEST(SplitSweeps, APartComesAfterTheSamplesThatSpanItAndBeforeLaterOnes) {
  SplitSweeps source(std::make_unique<listed::Events>(recording()), "lidar", 2);
  Time last_imu{-1};
  std::vector<Time> seen;
  for (const Event& event : all_of(source)) {
    if (const auto* sample = std::get_if<ImuSample>(&event.data)) {
      EXPECT_GT(sample->stamp, last_imu);
      last_imu = sample->stamp;
    } else {
      const auto& scan = std::get<Scan>(event.data);
      EXPECT_GE(last_imu, end_of(scan));
      EXPECT_LT(last_imu, end_of(scan) + milliseconds(6)) << "as live at twice the rate";
      seen.push_back(scan.stamp);
    }
  }
  EXPECT_EQ(seen, (std::vector<Time>{milliseconds(0), milliseconds(50), milliseconds(100),
                                     milliseconds(150)}));
}

TEST(SplitSweeps, OtherSensorsEmptySweepsAndTheEndPassThrough) {
  std::vector<Event> events{imu(0), sweep(0, "other"), {"lidar", Scan{}}, imu(5)};
  SplitSweeps source(std::make_unique<listed::Events>(events), "lidar", 2);
  const auto passed = all_of(source);
  ASSERT_EQ(passed.size(), 4U);
  EXPECT_EQ(passed[1].sensor_id, "other");
  EXPECT_EQ(std::get<Scan>(passed[1].data).points.size(), 100U);
}

TEST(SplitSweeps, RefusesSweepsWithoutTimes) {
  Event untimed = sweep(0);
  for (Point& point : std::get<Scan>(untimed.data).points) point.dt_ns = 0;
  SplitSweeps source(std::make_unique<listed::Events>(std::vector<Event>{untimed}), "lidar", 2);
  EXPECT_THROW(source.next(), InputError);
}

TEST(SceneSettings, AreSplitByWhatTheyAreOf) {
  const SceneSettings settings =
      scene_settings({"world.house.detail=2", "flight.style=brisk", "sensor.max_range_m=9",
                      "imu.rate_hz=100", "b.range_noise_m=0.1"},
                     {"sensors/a.yaml", "b.yaml"});
  EXPECT_EQ(settings.world, std::vector<std::string>{"house.detail=2"});
  EXPECT_EQ(settings.flight, std::vector<std::string>{"style=brisk"});
  EXPECT_EQ(settings.sensors[0], (std::vector<std::string>{"max_range_m=9", "imu.rate_hz=100"}));
  EXPECT_EQ(settings.sensors[1],
            (std::vector<std::string>{"max_range_m=9", "imu.rate_hz=100", "range_noise_m=0.1"}));
  for (const char* wrong : {"house.detail=2", "max_range_m=2", "sensor=2", "c.max_range_m=3"})
    EXPECT_THROW(scene_settings({wrong}, {"a.yaml"}), InputError) << wrong;
}

}  // namespace
}  // namespace lidarena::stages
