// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/imu_buffer.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace lidarena::estimation {
namespace {

Time ms(double t) { return from_seconds(1e-3 * t); }

ImuSample sample(double t_ms, const Eigen::Vector3d& gyro = Eigen::Vector3d::Zero(),
                 const Eigen::Vector3d& accel = Eigen::Vector3d::Zero()) {
  return {ms(t_ms), gyro, accel};
}

/// Samples every 5 ms from 0 to 100 ms, with a rate that grows by 1 rad/s per second.
ImuBuffer ramp() {
  ImuBuffer buffer(0.02);
  for (int i = 0; i <= 20; ++i) {
    const double t = 5.0 * i;
    buffer.add({ms(t), {1e-3 * t, 0.0, 0.0}, {0.0, 0.0, 9.8}});
  }
  return buffer;
}

double turn(const std::vector<ImuInterval>& intervals) {
  double sum = 0.0;
  for (const ImuInterval& interval : intervals) sum += interval.gyro.x() * interval.seconds();
  return sum;
}

TEST(ImuBuffer, AnySpanIsCoveredWithoutGapsAndSumsUpExactly) {
  const ImuBuffer buffer = ramp();
  const auto spans = {std::pair{0.0, 100.0}, {12.0, 13.0}, {7.5, 42.5}, {5.0, 10.0}};
  for (const auto& [begin, end] : spans) {
    const auto intervals = buffer.between(ms(begin), ms(end));
    ASSERT_FALSE(intervals.empty());
    EXPECT_EQ(intervals.front().begin, ms(begin));
    EXPECT_EQ(intervals.back().end, ms(end));
    for (std::size_t i = 0; i < intervals.size(); ++i) {
      EXPECT_LT(intervals[i].begin, intervals[i].end);
      EXPECT_FALSE(intervals[i].gap);
      if (i > 0) {
        EXPECT_EQ(intervals[i].begin, intervals[i - 1].end);
      }
    }
    // the area under the ramp
    EXPECT_NEAR(turn(intervals), 0.5e-6 * (end * end - begin * begin), 1e-15);
  }
  EXPECT_EQ(buffer.between(ms(7.5), ms(42.5)).size(), 8U) << "cut at 10, 15, ... 40";
}

TEST(ImuBuffer, BeyondTheSamplesTheNearestHoldsAndTooFarAwayIsAGap) {
  const ImuBuffer buffer = ramp();
  const auto after = buffer.between(ms(100.0), ms(115.0));
  ASSERT_EQ(after.size(), 1U);
  EXPECT_NEAR(after[0].gyro.x(), 0.1, 1e-12);
  EXPECT_FALSE(after[0].gap);
  EXPECT_TRUE(buffer.between(ms(100.0), ms(125.0)).back().gap);
  EXPECT_FALSE(buffer.between(ms(-10.0), ms(0.0)).front().gap);
  EXPECT_TRUE(buffer.between(ms(-30.0), ms(0.0)).front().gap);
  EXPECT_TRUE(ImuBuffer(0.02).between(ms(0.0), ms(1.0)).empty()) << "no samples";
  EXPECT_TRUE(buffer.between(ms(5.0), ms(5.0)).empty());
}

TEST(ImuBuffer, ASilenceIsAGap) {
  ImuBuffer buffer(0.02);
  for (const double t : {0.0, 5.0, 55.0, 60.0}) buffer.add(sample(t));
  const auto intervals = buffer.between(ms(0.0), ms(60.0));
  ASSERT_EQ(intervals.size(), 3U);
  EXPECT_FALSE(intervals[0].gap);
  EXPECT_TRUE(intervals[1].gap);
  EXPECT_FALSE(intervals[2].gap);
}

TEST(ImuBuffer, ForgettingChangesNoLaterAnswer) {
  const ImuBuffer all = ramp();
  ImuBuffer some = all;
  some.remove_before(ms(42.0));
  EXPECT_LT(some.memory_bytes(), all.memory_bytes());
  EXPECT_EQ(turn(some.between(ms(42.0), ms(80.0))), turn(all.between(ms(42.0), ms(80.0))));
  EXPECT_EQ(some.samples(ms(42.0), ms(80.0)).size(), 8U);
  some.remove_before(ms(500.0));
  EXPECT_FALSE(some.empty()) << "the last sample is used for all later times";
}

TEST(ImuBuffer, BadSamplesAreRefusedAndCounted) {
  ImuBuffer buffer = ramp();
  EXPECT_FALSE(buffer.add(sample(100.0))) << "not later";
  EXPECT_FALSE(buffer.add(sample(50.0)));
  EXPECT_FALSE(buffer.add(sample(200.0, {std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0})));
  EXPECT_EQ(buffer.refused(), 3U);
}

TEST(ImuBuffer, AStampFarAheadIsDroppedWhenTheNextSampleShowsThatItWasWrong) {
  ImuBuffer buffer(0.02);
  for (const double t : {0.0, 5.0, 10.0}) EXPECT_TRUE(buffer.add(sample(t)));
  EXPECT_TRUE(buffer.add(sample(900'000.0))) << "nothing speaks against it yet";
  EXPECT_TRUE(buffer.add(sample(15.0)));
  EXPECT_EQ(buffer.refused(), 1U);
  EXPECT_TRUE(buffer.add(sample(20.0)));
  EXPECT_EQ(buffer.samples(ms(0.0), ms(1e6)).size(), 5U);
  EXPECT_FALSE(buffer.between(ms(0.0), ms(20.0)).back().gap);
}

TEST(ImuBuffer, AFirstStampThatIsFollowedByAnEarlierOneStays) {
  ImuBuffer buffer(0.02);
  EXPECT_TRUE(buffer.add(sample(900'000.0)));
  EXPECT_FALSE(buffer.add(sample(15.0))) << "nothing shows which of the two is wrong";
  EXPECT_EQ(buffer.first_stamp(), ms(900'000.0));
}

TEST(ImuBuffer, ALargeValueRepeatedToTheLastBitIsSaturation) {
  ImuBuffer buffer(0.02);
  const double rates[] = {1.0, 3.0, 3.0, 2.9, 1.5, 1.5};  // rad/s; repeated small ones are quiet
  double t = 0.0;
  for (const double rate : rates) buffer.add(sample(t += 5.0, {0.0, rate, 0.0}));
  const auto intervals = buffer.between(ms(5.0), ms(30.0));
  ASSERT_EQ(intervals.size(), 5U);
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    EXPECT_EQ(intervals[i].gyro_clipped.y(), i <= 2) << i << ": one of its samples is 3.0";
    EXPECT_FALSE(intervals[i].gyro_clipped.x() || intervals[i].accel_clipped.any()) << i;
  }
  EXPECT_EQ(count_saturated(intervals), 3U);
  EXPECT_TRUE(buffer.between(ms(12.0), ms(13.0)).front().saturated()) << "also of a part of it";

  ImuBuffer in_g(0.02);
  in_g.set_accel_scale(9.8);
  for (const double s : {5.0, 10.0}) in_g.add(sample(s, Eigen::Vector3d::Zero(), {0.0, 0.0, 2.5}));
  EXPECT_EQ(count_saturated(in_g.between(ms(5.0), ms(10.0))), 1U) << "2.5 g";
}

TEST(ImuBuffer, TheLongestPauseIsBetweenSamplesOrAfterTheLast) {
  const std::vector<ImuSample> samples{sample(1000.0), sample(1100.0), sample(1400.0)};
  EXPECT_DOUBLE_EQ(longest_pause_s(samples, from_seconds(1.5)), 0.3);
  EXPECT_DOUBLE_EQ(longest_pause_s(samples, from_seconds(2.0)), 0.6);
  EXPECT_EQ(longest_pause_s({}, from_seconds(2.0)), 0.0);
}

}  // namespace
}  // namespace lidarena::estimation
