// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/scan_times.hpp"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace lidarena::estimation {
namespace {

Scan timed_scan(std::vector<Point> points, bool timed = true) {
  return {Time{1'000'000'000}, std::move(points), timed};
}

TEST(ScanTimes, RunFromTheEarliestPointToTheLatest) {
  const Scan scan = timed_scan({{{1, 0, 0}, 0, 500}, {{2, 0, 0}, 0, 100}, {{3, 0, 0}, 0, 200}});
  const ScanTimes times = times_of(scan, Time{77});
  EXPECT_EQ(times.first - scan.stamp, Time{100});
  EXPECT_EQ(times.last - scan.stamp, Time{500});
  EXPECT_TRUE(times.timed);
}

TEST(ScanTimes, AnEmptyScanLastsAsUsualAndOneWithoutTimesIsNotTimed) {
  const ScanTimes empty = times_of(timed_scan({}), Time{77});
  EXPECT_EQ(empty.last - empty.first, Time{77});
  EXPECT_FALSE(empty.timed);
  EXPECT_FALSE(times_of(timed_scan({{{1, 0, 0}, 0, 0}, {{2, 0, 0}, 0, 0}}), Time{77}).timed);
  EXPECT_FALSE(times_of(timed_scan({{{1, 0, 0}, 0, 0}, {{2, 0, 0}, 0, 9}}, false), Time{77}).timed);
}

}  // namespace
}  // namespace lidarena::estimation
