// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/stream_merge.hpp"

#include <gmock/gmock.h>

#include "lidarena/base/error.hpp"
#include "lidarena/base/random.hpp"
#include "tests/dataset/event_matching.hpp"
#include "tests/dataset/sample_events.hpp"

namespace lidarena::dataset {
namespace {

using std::chrono::milliseconds;

Event imu_at(Time stamp, const std::string& id = "imu") { return {id, ImuSample{.stamp = stamp}}; }

Event scan_between(Time start, Time end, const std::string& id = "lidar") {
  Scan scan{start, std::vector<Point>(2), true};
  scan.points[1].dt_ns = static_cast<std::int32_t>((end - start).count());
  return {id, scan};
}

/// All events that the merge has released.
std::vector<Event> popped(StreamMerge& merge) {
  std::vector<Event> events;
  while (auto event = merge.pop()) events.push_back(*std::move(event));
  return events;
}

std::vector<Event> merged(const std::vector<Event>& events, const std::vector<std::string>& imus) {
  StreamMerge merge("test", imus);
  std::vector<Event> out;
  for (const Event& event : events) {
    merge.push(event);
    for (Event& given : popped(merge)) out.push_back(std::move(given));
  }
  merge.finish();
  for (Event& given : popped(merge)) out.push_back(std::move(given));
  return out;
}

TEST(StreamMerge, AScanWaitsForTheImuSampleThatCoversItsLastPoint) {
  StreamMerge merge("test", {"imu"});
  merge.push(scan_between(milliseconds(0), milliseconds(99)));
  EXPECT_TRUE(popped(merge).empty());
  merge.push(imu_at(milliseconds(98)));
  EXPECT_THAT(popped(merge), testing::SizeIs(1));  // only the sample
  merge.push(imu_at(milliseconds(99)));
  const std::vector<Event> events = popped(merge);
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0].sensor_id, "imu");
  EXPECT_EQ(events[1].sensor_id, "lidar");
}

TEST(StreamMerge, AScanWaitsForTheSlowestImu) {
  StreamMerge merge("test", {"a", "b"});
  merge.push(scan_between(milliseconds(0), milliseconds(99)));
  merge.push(imu_at(milliseconds(200), "a"));
  EXPECT_THAT(popped(merge), testing::SizeIs(1));
  merge.push(imu_at(milliseconds(100), "b"));
  EXPECT_THAT(popped(merge), testing::SizeIs(2));
}

TEST(StreamMerge, WithoutAnImuScansPassAtOnce) {
  StreamMerge merge("test", {});
  merge.push(scan_between(milliseconds(0), milliseconds(99)));
  EXPECT_THAT(popped(merge), testing::SizeIs(1));
}

TEST(StreamMerge, WhatKeepsThePromisePassesUnchanged) {
  const std::vector<Event> events = sample::events(5, 20);
  expect_same(merged(events, {"mid360"}), events);
}

// In files, scans come too early (written at their start) or too late, with varying delays.
TEST(StreamMerge, KeepsThePromiseForAnyDelayOfTheScans) {
  const std::vector<Event> ordered = sample::events(20, 20);
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    SequentialRandom random(seed);
    const double delay_s = random.uniform(-0.05, 0.3);
    std::vector<std::pair<Time, Event>> written;
    for (const Event& event : ordered) {
      const auto* scan = std::get_if<Scan>(&event.data);
      written.emplace_back(scan == nullptr
                               ? std::get<ImuSample>(event.data).stamp
                               : scan->stamp + from_seconds(delay_s + random.uniform(0.0, 0.09)),
                           event);
    }
    std::ranges::stable_sort(written, {}, &std::pair<Time, Event>::first);
    std::vector<Event> in_file_order;
    for (auto& [time, event] : written) in_file_order.push_back(std::move(event));

    Time covered = Time::min();
    std::size_t scans = 0;
    for (const Event& event : merged(in_file_order, {"mid360"})) {
      if (const auto* sample = std::get_if<ImuSample>(&event.data)) {
        covered = sample->stamp;
      } else {
        EXPECT_LE(end_of(std::get<Scan>(event.data)), covered) << "seed " << seed;
        ++scans;
      }
    }
    EXPECT_EQ(scans, 20U);
  }
}

TEST(StreamMerge, AtTheEndTheScansThatWaitAreGivenOut) {
  const std::vector<Event> events{imu_at(milliseconds(50)),
                                  scan_between(milliseconds(0), milliseconds(99)),
                                  scan_between(milliseconds(100), milliseconds(199))};
  EXPECT_THAT(merged(events, {"imu"}), testing::SizeIs(3));
}

TEST(StreamMerge, TimeThatRunsBackwardsIsBadInput) {
  StreamMerge merge("test", {"imu"});
  merge.push(imu_at(milliseconds(5)));
  merge.push(imu_at(milliseconds(5)));  // some drivers repeat a sample
  EXPECT_THROW(merge.push(imu_at(milliseconds(4))), InputError);
  merge.push(scan_between(milliseconds(1), milliseconds(2)));
  EXPECT_THROW(merge.push(scan_between(milliseconds(1), milliseconds(2))), InputError);
}

TEST(StreamMerge, AnImuThatFallsSilentIsNamedBeforeMemoryFills) {
  StreamMerge merge("test", {"imu"});
  merge.push(imu_at(milliseconds(0)));
  const auto push_scans = [&] {
    for (int i = 0; i < 100; ++i) {
      merge.push(scan_between(milliseconds(100 * i), milliseconds(100 * i + 99)));
    }
  };
  try {
    push_scans();
    FAIL() << "scans accumulated without an error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr("IMU 'imu' has no sample from"),
                                             testing::HasSubstr("0.099000000 s")));
  }
}

}  // namespace
}  // namespace lidarena::dataset
