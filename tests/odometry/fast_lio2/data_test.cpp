// SPDX-License-Identifier: BSD-3-Clause
// Tests of FAST-LIO2 as a whole: its start, points out of order, and faulty data.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>

#include "lidarena/base/time.hpp"
#include "lidarena/odometry/fast_lio2/fast_lio2.hpp"
#include "tests/odometry/playback.hpp"

namespace lidarena::odometry::fast_lio2 {
namespace {

using synthetic::Outcome;
using synthetic::Recording;

constexpr double kTracked = 0.1;  // m; half a voxel of the map, lost tracking gives meters

/// The beams of each scan are between those of the others: beams that hit the same places in each
/// scan hold the pose at the start.
const std::vector<Event>& usual_events() {
  static const std::vector<Event> events = synthetic::record({.repeating = false});
  return events;
}

std::vector<Event> with_imu(const std::function<bool(ImuSample&)>& change) {
  return synthetic::with_imu(change, usual_events());
}

Outcome play(const std::vector<Event>& events) {
  const Rig rig = synthetic::rig_of({});
  FastLio2 odometry(indoor(rig.lidars.front()), rig.lidars.front(), rig.imus.front(), Parallel(1));
  return synthetic::play(events, odometry);
}

/// The usual events with `change` applied to each scan.
template <class Change>
std::vector<Event> with_scans(const Change& change) {
  std::vector<Event> events = usual_events();
  for (Event& event : events)
    if (auto* scan = std::get_if<Scan>(&event.data)) change(*scan);
  return events;
}

TEST(FastLio2Data, TheFirstScansInitializeAndTheFourthIsTheFirstUpdate) {
  const Outcome outcome = play(usual_events());
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_EQ(outcome.results[i].status, ScanStatus::kInitializing) << i;
  EXPECT_EQ(outcome.results[1].detail("map_points"), 0.0);
  EXPECT_GT(outcome.results[2].detail("map_points").value(), 100.0);
  EXPECT_EQ(outcome.count(ScanStatus::kTracked), 37U);
  EXPECT_LT(outcome.final_error({}), kTracked);
}

TEST(FastLio2Data, AScanEndsWithTheLastPointOfItsMessage) {
  // Rows of a spinning sensor one after the other: the last row ends 3 ms before the latest point.
  const auto events = with_scans([](Scan& scan) {
    std::stable_partition(scan.points.begin(), scan.points.end(),
                          [](const Point& point) { return point.dt_ns > 96'900'000; });
  });
  const Outcome outcome = play(events);
  std::size_t index = 0;
  for (const Event& event : events) {
    const auto* scan = std::get_if<Scan>(&event.data);
    if (scan == nullptr) continue;
    const ScanResult& result = outcome.results[index++];
    const double seconds = to_seconds(result.estimate.stamp - scan->stamp);
    EXPECT_GT(seconds, 0.096);
    EXPECT_LT(seconds, 0.0969);
    EXPECT_GT(end_of(*scan), result.estimate.stamp + from_seconds(0.002));
  }
  EXPECT_EQ(outcome.count(ScanStatus::kTracked), 37U);
  EXPECT_LT(outcome.final_error({}), kTracked);
}

TEST(FastLio2Data, TheMotionWithinAScanIsThatOfTheFlight) {
  const Outcome outcome = play(usual_events());
  for (std::size_t i = 10; i < outcome.results.size(); ++i) {
    const ScanResult& result = outcome.results[i];
    ASSERT_GT(result.motion.size(), 15U) << "an IMU at 200 Hz";
    EXPECT_EQ(result.motion.back().stamp, result.estimate.stamp);
    EXPECT_TRUE(
        result.motion.back().world_from_body.isApprox(result.estimate.world_from_body, 1e-9));
    const StampedPose& begin = result.motion.front();
    const Pose moved = begin.world_from_body.inverse() * result.estimate.world_from_body;
    const Pose expected = synthetic::truth({}, begin.stamp, result.estimate.stamp);
    // Mean speed over the scan to 0.1 m/s: half a voxel per second.
    EXPECT_LT((moved.translation() - expected.translation()).norm(), 0.01) << i;
  }
}

TEST(FastLio2Data, TheBufferOfAllPublishedPointsIsCounted) {
  const Rig rig = synthetic::rig_of({});
  Config config = indoor(rig.lidars.front());
  const auto bytes_kept = [&](bool keep) {
    config.keep_all_scans = keep;
    FastLio2 odometry(config, rig.lidars.front(), rig.imus.front(), Parallel(1));
    const Outcome outcome = synthetic::play(usual_events(), odometry);
    std::uint64_t points = 0;
    for (std::size_t i = 3; i < outcome.results.size(); ++i)
      points += outcome.results[i].counters.points.value();
    return std::pair{odometry.memory().scan_buffer, points};
  };
  const auto [bytes, points] = bytes_kept(true);
  EXPECT_EQ(bytes - bytes_kept(false).first, 48 * points);
}

TEST(FastLio2Data, AccelerationsInGGiveTheSamePoses) {
  const auto scaled = with_imu([](ImuSample& sample) {
    sample.accel /= 9.80665;
    return true;
  });
  const Outcome in_g = play(scaled);
  const Outcome usual = play(usual_events());
  EXPECT_NEAR(in_g.results.back().detail("accel_scale").value(),
              9.80665 * usual.results.back().detail("accel_scale").value(), 1e-9);
  EXPECT_LT((in_g.results.back().estimate.world_from_body.translation() -
             usual.results.back().estimate.world_from_body.translation())
                .norm(),
            1e-6);
}

TEST(FastLio2Data, SamplesOutOfOrderOrNotFiniteAreRefusedAndCounted) {
  std::vector<Event> events;
  std::uint64_t bad = 0;
  for (const Event& event : usual_events()) {
    events.push_back(event);
    const auto* sample = std::get_if<ImuSample>(&event.data);
    if (sample == nullptr || events.size() % 10 != 0) continue;
    ImuSample wrong = *sample;
    wrong.gyro.setConstant(++bad % 2 == 0 ? std::numeric_limits<double>::quiet_NaN() : 3.0);
    wrong.stamp += bad % 2 == 0 ? Time{1} : from_seconds(-0.5);
    events.push_back({"imu", wrong});
  }
  const Outcome outcome = play(events);
  EXPECT_EQ(outcome.results.back().detail("imu_refused"), bad);
  EXPECT_EQ(outcome.results.back().estimate.world_from_body.matrix(),
            play(usual_events()).results.back().estimate.world_from_body.matrix());
}

TEST(FastLio2Data, AScanFromThePastIsRefused) {
  std::vector<Event> events;
  std::size_t index = 0;
  Event old;
  for (const Event& event : usual_events()) {
    events.push_back(event);
    if (!std::holds_alternative<Scan>(event.data)) continue;
    if (index == 10) old = event;
    if (++index == 25) events.push_back(old);
  }
  const Outcome outcome = play(events);
  const ScanResult& refused = outcome.results[25];
  EXPECT_EQ(refused.status, ScanStatus::kRefused);
  EXPECT_EQ(refused.estimate.stamp, outcome.results[24].estimate.stamp);
  EXPECT_TRUE(refused.motion.empty());
  EXPECT_EQ(outcome.results.back().estimate.world_from_body.matrix(),
            play(usual_events()).results.back().estimate.world_from_body.matrix());
}

TEST(FastLio2Data, DroppedScansAreBridgedByTheImu) {
  std::vector<Event> events;
  int index = 0;
  for (const Event& event : usual_events()) {
    const bool dropped = std::holds_alternative<Scan>(event.data) && ++index > 20 && index <= 23;
    if (!dropped) events.push_back(event);
  }
  EXPECT_LT(play(events).final_error({}), kTracked);
}

TEST(FastLio2Data, AnImuThatFallsSilentIsToldAndSurvived) {
  const auto events = with_imu(
      [](const ImuSample& sample) { return sample.stamp < Recording{}.epoch + from_seconds(2.5); });
  const Outcome outcome = play(events);
  EXPECT_EQ(outcome.results[20].detail("imu_gap_s"), 0.0);
  EXPECT_GT(outcome.results.back().detail("imu_gap_s").value(), 1.0);
  for (const ScanResult& result : outcome.results)
    EXPECT_TRUE(result.estimate.world_from_body.matrix().allFinite());
}

TEST(FastLio2Data, ARateBeyondAllReasonIsToldAsDiverged) {
  const auto events = with_imu([](ImuSample& sample) {
    if (sample.stamp > Recording{}.epoch + from_seconds(2.5)) sample.accel.setConstant(1e300);
    return true;
  });
  const Outcome outcome = play(events);
  EXPECT_EQ(outcome.results.size(), 40U);
  EXPECT_EQ(outcome.results.back().status, ScanStatus::kDiverged);
}

}  // namespace
}  // namespace lidarena::odometry::fast_lio2
