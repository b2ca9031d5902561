// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/fast_lio2/preprocess.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>
#include <limits>

#include "lidarena/base/angle.hpp"
#include "lidarena/base/so3.hpp"
#include "lidarena/base/time.hpp"

namespace lidarena::odometry::fast_lio2 {
namespace {

constexpr Time kStamp{5'000'000'000};

/// Points at 2, 3, 4 ... m on the x axis with these times (ms).
Scan scan_at(std::initializer_list<double> times_ms) {
  Scan scan;
  scan.stamp = kStamp;
  for (const double ms : times_ms) {
    Point point;
    point.position.x() = 2.0F + static_cast<float>(scan.points.size());
    point.dt_ns = static_cast<std::int32_t>(1e6 * ms);
    scan.points.push_back(point);
  }
  return scan;
}

std::vector<float> ranges(const Scan& scan) {
  std::vector<float> all;
  for (const Point& point : scan.points) all.push_back(point.position.x());
  return all;
}

TEST(FastLio2Preprocess, TakesEveryNthPointOfTheMessageAndNeverTheFirstOfALivox) {
  const Config config{.point_stride = 3, .min_range_m = 0.5};
  const Scan scan = scan_at({0, 1, 2, 3, 4, 5, 6, 7});
  EXPECT_EQ(ranges(selected_points(scan, config, false)), (std::vector<float>{2, 5, 8}));
  EXPECT_EQ(ranges(selected_points(scan, config, true)), (std::vector<float>{5, 8}));
}

/// Two rings that fire together at these azimuths (degrees), without times.
Scan scan_of_azimuths(const std::vector<double>& azimuths_deg) {
  Scan scan{.stamp = kStamp, .points = {}, .timed = false};
  for (const double deg : azimuths_deg) {
    for (std::uint16_t ring = 0; ring < 2; ++ring) {
      Point point;
      const double rad = deg * kDegree;
      point.position = {static_cast<float>(5.0 * std::cos(rad)),
                        static_cast<float>(5.0 * std::sin(rad)), static_cast<float>(ring)};
      point.ring = ring;
      scan.points.push_back(point);
    }
  }
  return scan;
}

TEST(FastLio2Preprocess, TimesFromTheAzimuthAreRightForASensorThatTurnsClockwise) {
  std::vector<double> azimuths;
  for (int column = 0; column < 72; ++column) azimuths.push_back(170.0 - 5.0 * column);
  const Scan timed = with_azimuth_times(scan_of_azimuths(azimuths), 10.0);
  EXPECT_TRUE(timed.timed);
  EXPECT_TRUE(timed.points[0].position.hasNaN() && timed.points[1].position.hasNaN());
  EXPECT_FALSE(timed.points[2].position.hasNaN());
  for (std::size_t i = 2; i < timed.points.size(); ++i)  // 361 degrees in 100 ms
    EXPECT_NEAR(1e-6 * timed.points[i].dt_ns, 5.0 * static_cast<double>(i / 2) / 3.61, 1e-4);
  // A run of every second point begins with the dropped first one.
  const Config config{.point_stride = 2, .min_range_m = 0.5};
  EXPECT_EQ(selected_points(timed, config, false).points.size(), 71U);
}

TEST(FastLio2Preprocess, TimesFromTheAzimuthFallInASecondRevolutionIfTheSensorTurnsTheOtherWay) {
  const Scan timed = with_azimuth_times(scan_of_azimuths({-180, -170, -160, -150}), 10.0);
  EXPECT_NEAR(1e-6 * timed.points[2].dt_ns, 350.0 / 3.61, 1e-4);
  EXPECT_NEAR(1e-6 * timed.points[4].dt_ns, (340.0 + 360.0) / 3.61, 1e-4);
  EXPECT_NEAR(1e-6 * timed.points[6].dt_ns, (330.0 + 360.0) / 3.61, 1e-4);
}

TEST(FastLio2Preprocess, LeavesOutWhatIsTooNearOrNotFinite) {
  const Config config{.point_stride = 1, .min_range_m = 2.5};
  Scan scan = scan_at({0, 1, 2, 3});
  scan.points[2].position.y() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(ranges(selected_points(scan, config, false)), (std::vector<float>{3, 5}));
}

TEST(FastLio2Preprocess, AScanEndsWithTheLastPointInOrderNotInTime) {
  ScanClock clock;
  EXPECT_EQ(clock.end_of(scan_at({0, 50, 100})), kStamp + from_seconds(0.1));
  EXPECT_EQ(clock.end_of(scan_at({0, 100, 97})), kStamp + from_seconds(0.097));
}

TEST(FastLio2Preprocess, ATooShortScanEndsAfterTheMeanDuration) {
  ScanClock clock;
  EXPECT_EQ(clock.end_of(Scan{.stamp = kStamp, .points = {}}), kStamp) << "nothing is known yet";
  clock.end_of(scan_at({0, 90}));
  clock.end_of(scan_at({0, 110}));
  EXPECT_EQ(clock.end_of(scan_at({0, 100, 40})), kStamp + from_seconds(0.1));
  EXPECT_EQ(clock.end_of(scan_at({70})), kStamp + from_seconds(0.1)) << "one point";
  EXPECT_EQ(clock.end_of(scan_at({})), kStamp + from_seconds(0.1));
  EXPECT_EQ(clock.end_of(scan_at({0, 60})), kStamp + from_seconds(0.06)) << "more than half";
  Scan untimed = scan_at({0, 0});
  untimed.timed = false;
  EXPECT_EQ(clock.end_of(untimed), kStamp);
}

/// Motion with constant velocity along x and rotation about z from the scan's begin on.
constexpr double kSpeed = 2.0;  // m/s
constexpr double kRate = 1.5;   // rad/s
Pose pose_after(double seconds) {
  return make_pose(so3::exp({0, 0, kRate * seconds}), {kSpeed * seconds, 0, 0});
}

estimation::ImuTrack track_from(Time begin) {
  estimation::ImuTrack track;
  for (const double seconds : {0.0, 0.04, 0.08}) {
    track.push_back({begin + from_seconds(seconds),
                     pose_after(seconds),
                     {kSpeed, 0, 0},
                     Eigen::Vector3d::Zero(),
                     {0, 0, kRate}});
  }
  return track;
}

TEST(FastLio2Preprocess, PointsAreMovedToTheEndExceptThoseOfTheFirstInstant) {
  // Not in order of time, and the last one is not the latest.
  const Scan scan = scan_at({90, 0, 30, 100, 40, 0, 97});
  estimation::InertialState at_end;
  at_end.nav.world_from_imu = pose_after(0.097);
  const auto moved = propagate_backward(scan, track_from(kStamp), at_end, Parallel(1));
  for (std::size_t i = 0; i < moved.size(); ++i) {
    const Point& point = scan.points[i];
    const Pose end_from_then =
        pose_after(0.097).inverse() * pose_after(1e-9 * static_cast<double>(point.dt_ns));
    const Eigen::Vector3f expected = (end_from_then * point.position.cast<double>()).cast<float>();
    if (point.dt_ns == 0) {
      EXPECT_EQ(moved[i], point.position);
      EXPECT_GT((moved[i] - expected).norm(), 0.2F) << "an error of the program";
    } else {
      EXPECT_LT((moved[i] - expected).norm(), 1e-5F) << i;
    }
  }
}

TEST(FastLio2Preprocess, TheEarliestPointIsMovedAgainForEachEarlierStep) {
  const Scan scan = scan_at({60, 50, 90});  // steps begin at 0, 40 and 80 ms
  estimation::InertialState at_end;
  at_end.nav.world_from_imu = pose_after(0.1);
  const auto moved = propagate_backward(scan, track_from(kStamp), at_end, Parallel(1));
  const Pose once = pose_after(0.1).inverse() * pose_after(0.05);
  const Eigen::Vector3f expected = (once * once * Eigen::Vector3d(3, 0, 0)).cast<float>();
  EXPECT_LT((moved[1] - expected).norm(), 1e-5F) << "an error of the program";
  const Pose other = pose_after(0.1).inverse() * pose_after(0.06);
  EXPECT_LT((moved[0] - (other * Eigen::Vector3d(2, 0, 0)).cast<float>()).norm(), 1e-5F);
}

TEST(FastLio2Preprocess, AfterADroppedScanTheFirstInstantIsMovedToo) {
  const Scan scan = scan_at({0, 0, 50});
  estimation::InertialState at_end;
  at_end.nav.world_from_imu = pose_after(0.15);  // the track begins 0.1 s before the scan
  const auto moved =
      propagate_backward(scan, track_from(kStamp - from_seconds(0.1)), at_end, Parallel(1));
  const Pose once = pose_after(0.15).inverse() * pose_after(0.1);
  EXPECT_LT((moved[1] - (once * Eigen::Vector3d(3, 0, 0)).cast<float>()).norm(), 1e-5F);
}

TEST(FastLio2Preprocess, UntimedScansAndScansWithoutATrackStayAsTheyAre) {
  Scan scan = scan_at({0, 50});
  const estimation::InertialState state;
  EXPECT_EQ(propagate_backward(scan, {}, state, Parallel(1))[1], scan.points[1].position);
  scan.timed = false;
  EXPECT_EQ(propagate_backward(scan, track_from(kStamp), state, Parallel(1))[1],
            scan.points[1].position);
}

}  // namespace
}  // namespace lidarena::odometry::fast_lio2
