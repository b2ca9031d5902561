// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/stages/read_ahead.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>

#include "lidarena/base/error.hpp"

namespace lidarena::stages {
namespace {

/// A scan each 0.1 s with four samples of the IMU before it; throws after the last.
class Flight final : public EventSource {
 public:
  Flight(int events, bool breaks, std::atomic<int>& given)
      : events_(events), breaks_(breaks), given_(given) {}
  std::optional<Event> next() override {
    if (given_ == events_) {
      if (breaks_) throw InputError("flight", "ends in the rain");
      return std::nullopt;
    }
    const Time stamp = std::chrono::milliseconds(20 * given_);
    ImuSample sample;
    sample.stamp = stamp;
    if (++given_ % 5 != 0) return Event{"imu", sample};
    return Event{"lidar", Scan{stamp, {}}};
  }

 private:
  int events_;
  bool breaks_;
  std::atomic<int>& given_;
};

Time stamp_of(const Event& event) {
  return std::visit([](const auto& data) { return data.stamp; }, event.data);
}

TEST(ReadAhead, ReturnsAllEventsInTheirOrder) {
  std::atomic<int> given = 0;
  ReadAhead events(std::make_unique<Flight>(1000, false, given));
  for (int i = 0; i < 1000; ++i) {
    const auto event = events.next();
    ASSERT_TRUE(event);
    EXPECT_EQ(stamp_of(*event), std::chrono::milliseconds(20 * i));
  }
  EXPECT_FALSE(events.next());
  EXPECT_FALSE(events.next());
}

TEST(ReadAhead, ReadsAheadAsFarAsItMay) {
  std::atomic<int> given = 0;
  ReadAhead events(std::make_unique<Flight>(1000, false, given), 3);
  for (int i = 0; i < 200 && given < 16; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_EQ(given, 16) << "three scans, and the event that waits for its place";
}

TEST(ReadAhead, WhatItsSourceThrowsComesAfterTheEventsBefore) {
  std::atomic<int> given = 0;
  ReadAhead events(std::make_unique<Flight>(7, true, given));
  for (int i = 0; i < 7; ++i) EXPECT_TRUE(events.next());
  EXPECT_THROW(events.next(), InputError);
}

}  // namespace
}  // namespace lidarena::stages
