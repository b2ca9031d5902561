// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <vector>

#include "lidarena/base/event.hpp"

namespace lidarena::dataset {

inline void expect_same(const ImuSample& a, const ImuSample& b) {
  EXPECT_EQ(a.stamp, b.stamp);
  EXPECT_EQ(a.gyro, b.gyro);
  EXPECT_EQ(a.accel, b.accel);
}

inline bool is_same(const Point& a, const Point& b) {
  return std::memcmp(a.position.data(), b.position.data(), 3 * sizeof(float)) == 0 &&
         std::memcmp(&a.intensity, &b.intensity, sizeof(float)) == 0 && a.dt_ns == b.dt_ns &&
         a.ring == b.ring && a.echo == b.echo;
}

inline void expect_same(const Scan& a, const Scan& b) {
  EXPECT_EQ(a.stamp, b.stamp);
  EXPECT_EQ(a.timed, b.timed);
  ASSERT_EQ(a.points.size(), b.points.size());
  for (std::size_t i = 0; i < a.points.size(); ++i) {
    ASSERT_TRUE(is_same(a.points[i], b.points[i])) << "point " << i;
  }
}

/// Every field of every event, bit by bit.
inline void expect_same(const std::vector<Event>& a, const std::vector<Event>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    SCOPED_TRACE("event " + std::to_string(i));
    EXPECT_EQ(a[i].sensor_id, b[i].sensor_id);
    ASSERT_EQ(a[i].data.index(), b[i].data.index());
    if (const auto* sample = std::get_if<ImuSample>(&a[i].data)) {
      expect_same(*sample, std::get<ImuSample>(b[i].data));
    } else {
      expect_same(std::get<Scan>(a[i].data), std::get<Scan>(b[i].data));
    }
  }
}

/// All events of a source.
inline std::vector<Event> drain(EventSource& source) {
  std::vector<Event> events;
  while (auto event = source.next()) events.push_back(*std::move(event));
  return events;
}

}  // namespace lidarena::dataset
