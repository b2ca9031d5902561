// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/stages/event_record.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "lidarena/base/so3.hpp"

namespace lidarena::stages {
namespace {

using dataset::RunEvent;
using dataset::RunEventKind;

constexpr Time kStart = std::chrono::hours(24);
constexpr double kRadian = std::numbers::pi / 180.0;

Time at(double seconds) { return kStart + from_seconds(seconds); }

Scan scan_at(double seconds) {
  Scan scan;
  scan.stamp = at(seconds);
  Point last;
  last.dt_ns = 100'000'000;
  scan.points = {Point{}, last};
  return scan;
}

odometry::ScanResult result_with(odometry::ScanStatus status,
                                 const odometry::ScanCounters& counters = {}) {
  odometry::ScanResult result;
  result.estimate.stamp = kStart;
  result.status = status;
  result.counters = counters;
  return result;
}

/// Samples at 200 Hz from `begin` to `end`, turning about z.
void turn(EventRecord& record, double begin, double end, double deg_s) {
  for (double t = begin; t < end - 1e-9; t += 0.005) {
    ImuSample sample;
    sample.stamp = at(t);
    sample.gyro.z() = -deg_s * kRadian;
    record.add(sample);
  }
}

TEST(EventRecord, ATurnLastsAsLongAsTheGyroscopeExceedsTheThreshold) {
  EventRecord record;
  turn(record, 0.0, 1.0, 0.98 * kFastTurnDegS);
  turn(record, 1.0, 1.5, 1.5 * kFastTurnDegS);
  turn(record, 1.5, 1.55, 0.0);  // a short pause
  turn(record, 1.55, 2.0, 2.0 * kFastTurnDegS);
  turn(record, 2.0, 3.0, 0.0);
  turn(record, 3.0, 3.1, 1.1 * kFastTurnDegS);
  const std::vector<RunEvent> events = record.events(at(-1.0));
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0].kind, RunEventKind::kFastTurn);
  EXPECT_NEAR(events[0].t_sensor_s, 2.0, 0.006);
  EXPECT_NEAR(events[0].duration_s, 1.0, 0.006);
  EXPECT_NEAR(events[0].value, 2.0 * kFastTurnDegS, 1e-9);
  EXPECT_NEAR(events[1].t_sensor_s, 4.0, 0.006);
}

TEST(EventRecord, WithoutAnImuTurnsAreThoseOfTheEstimates) {
  const auto turns_of = [](bool has_imu) {
    EventRecord record;
    if (has_imu) turn(record, 0.0, 0.1, 0.0);
    for (int i = 0; i < 10; ++i) {
      odometry::ScanResult result = result_with(odometry::ScanStatus::kTracked);
      result.estimate.stamp = at(0.1 * i);
      const double angle = i <= 4 ? 0.0 : 10.0 * kRadian * (i - 4);  // 100 deg/s from 0.4 s on
      result.estimate.world_from_body.linear() = so3::exp({0.0, angle, 0.0});
      record.add(scan_at(0.1 * i), result);
    }
    return record.events(kStart);
  };
  const std::vector<RunEvent> turns = turns_of(false);
  ASSERT_EQ(turns.size(), 1U);
  EXPECT_NEAR(turns[0].t_sensor_s, 0.4, 1e-9);
  EXPECT_NEAR(turns[0].duration_s, 0.5, 1e-9);
  EXPECT_NEAR(turns[0].value, 100.0, 1e-6);
  EXPECT_TRUE(turns_of(true).empty()) << "the gyroscope knows better";
}

TEST(EventRecord, AGapOfTheImuIsNoTurn) {
  EventRecord record;
  turn(record, 0.0, 1.0, 0.0);
  turn(record, 1.25, 1.255, 10.0 * kFastTurnDegS);
  ImuSample late;
  late.stamp = at(0.5);
  record.add(late);
  turn(record, 1.255, 2.0, 0.0);
  const std::vector<RunEvent> events = record.events(kStart);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].kind, RunEventKind::kImuGap);
  EXPECT_NEAR(events[0].t_sensor_s, 0.995, 1e-9);
  EXPECT_NEAR(events[0].duration_s, 0.255, 1e-9);
  EXPECT_NEAR(events[0].value, 0.255, 1e-9);
}

TEST(EventRecord, SuccessiveScansOfOneKindAreOneEventWithTheWorstValue) {
  EventRecord record;
  record.add(scan_at(0.0), result_with(odometry::ScanStatus::kInitializing));
  record.add(scan_at(0.1), result_with(odometry::ScanStatus::kTooFewPoints, {.points = 40}));
  record.add(scan_at(0.2), result_with(odometry::ScanStatus::kTooFewPoints, {.points = 7}));
  record.add(scan_at(0.3), result_with(odometry::ScanStatus::kTooFewPoints));  // two points
  record.add(scan_at(0.4), result_with(odometry::ScanStatus::kTracked));
  record.add(scan_at(0.5),
             result_with(odometry::ScanStatus::kDegenerate, {.degenerate_directions = 2}));
  record.add(scan_at(0.6), result_with(odometry::ScanStatus::kDegenerate));
  record.add(scan_at(0.7), result_with(odometry::ScanStatus::kTracked, {.imu_saturated = 3}));
  const std::vector<RunEvent> events = record.events(kStart);
  ASSERT_EQ(events.size(), 3U);
  EXPECT_EQ(events[0].kind, RunEventKind::kFewPoints);
  EXPECT_NEAR(events[0].t_sensor_s, 0.1, 1e-9);
  EXPECT_NEAR(events[0].duration_s, 0.3, 1e-9);
  EXPECT_EQ(events[0].value, 2.0);
  EXPECT_EQ(events[1].kind, RunEventKind::kDegenerate);
  EXPECT_NEAR(events[1].duration_s, 0.2, 1e-9);
  EXPECT_EQ(events[1].value, 2.0);
  EXPECT_EQ(events[2].kind, RunEventKind::kImuSaturated);
  EXPECT_EQ(events[2].value, 3.0);
}

TEST(EventRecord, CountersThatGrowAndTheEndAreInstants) {
  EventRecord record;
  record.add(scan_at(0.0),
             result_with(odometry::ScanStatus::kTracked, {.imu_restarts = 0, .loops = 0}));
  record.add(scan_at(0.1),
             result_with(odometry::ScanStatus::kTracked, {.imu_restarts = 0, .loops = 2}));
  record.add(scan_at(0.2),
             result_with(odometry::ScanStatus::kTracked, {.imu_restarts = 1, .loops = 2}));
  record.add(scan_at(0.3),
             result_with(odometry::ScanStatus::kTracked, {.imu_restarts = 1, .loops = 3}));
  odometry::ScanResult broken = result_with(odometry::ScanStatus::kTracked);
  broken.estimate.world_from_body.translation().x() = std::numeric_limits<double>::quiet_NaN();
  record.add(scan_at(0.4), broken);
  const std::vector<RunEvent> events = record.events(kStart);
  ASSERT_EQ(events.size(), 4U);
  const std::vector<RunEventKind> kinds{RunEventKind::kLoop, RunEventKind::kImuRestart,
                                        RunEventKind::kLoop, RunEventKind::kDiverged};
  const std::vector<double> times{0.2, 0.3, 0.4, 0.5}, values{2, 1, 1, 4};
  for (std::size_t i = 0; i < events.size(); ++i) {
    EXPECT_EQ(events[i].kind, kinds[i]);
    EXPECT_NEAR(events[i].t_sensor_s, times[i], 1e-9);
    EXPECT_EQ(events[i].duration_s, 0.0);
    EXPECT_EQ(events[i].value, values[i]);
  }
}

}  // namespace
}  // namespace lidarena::stages
