// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lio/slices.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace lidarena::odometry::arena_lio {
namespace {

using std::chrono::milliseconds;

/// Steps of 5 ms from 0 to 100 ms.
std::vector<estimation::ImuInterval> steps() {
  std::vector<estimation::ImuInterval> intervals;
  for (int i = 0; i < 20; ++i) {
    intervals.push_back({.begin = milliseconds(5 * i), .end = milliseconds(5 * i + 5)});
    intervals.back().gyro.x() = i;
  }
  return intervals;
}

TEST(Slices, AreAsManyAsTheNoiseIntegratedTwiceAsksFor) {
  for (const double density : {1e-3, 0.01, 0.03, 0.1}) {
    const int count = slices_needed(steps(), density, 1e-4);
    const auto error = [&](int n) { return density * std::sqrt(std::pow(0.1 / n, 3) / 3.0); };
    EXPECT_TRUE(error(count) <= 1e-4 || count == 8) << density;
    EXPECT_TRUE(count == 1 || error(count - 1) > 1e-4) << density;
  }
  EXPECT_EQ(slices_needed({}, 1.0, 1e-4), 1);
}

TEST(Slices, ShareThePointsAndTheMotionByTime) {
  Scan scan{.stamp = milliseconds(10), .points = {}, .timed = true};
  for (std::int32_t i = 0; i < 90; ++i)  // one each ms, in no order
    scan.points.push_back({.dt_ns = (i * 37 % 90) * 1000000});
  const std::vector<Slice> slices = sliced(scan, milliseconds(100), steps(), 4);
  ASSERT_EQ(slices.size(), 4U);
  Time expected{0};
  std::size_t points = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    const Time begin = milliseconds(10) + Time(milliseconds(90)) * static_cast<int>(k) / 4;
    const Time end = milliseconds(10) + Time(milliseconds(90)) * static_cast<int>(k + 1) / 4;
    for (const Point& point : slices[k].points.points) {
      EXPECT_GE(time_of(scan, point), begin);
      EXPECT_LT(time_of(scan, point), end);
    }
    points += slices[k].points.points.size();
    for (const estimation::ImuInterval& interval : slices[k].intervals) {
      EXPECT_EQ(interval.begin, expected) << "no gap and no overlap";
      EXPECT_EQ(interval.gyro.x(), std::floor(to_seconds(interval.begin) / 0.005 + 1e-9));
      expected = interval.end;
    }
    EXPECT_EQ(expected, k == 3 ? milliseconds(100) : end);
  }
  EXPECT_EQ(points, 90U);
}

}  // namespace
}  // namespace lidarena::odometry::arena_lio
