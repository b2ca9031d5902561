// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/kiss_icp/preprocess.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "lidarena/base/se3.hpp"
#include "tests/odometry/kiss_icp/motions.hpp"

namespace lidarena::odometry::kiss_icp {
namespace {

using se3::Vector6;

Scan scan_of(std::initializer_list<Eigen::Vector3f> positions, std::int32_t step_ns) {
  Scan scan;
  scan.stamp = Time{1000};
  for (const auto& position : positions) {
    Point point;
    point.position = position;
    point.dt_ns = step_ns * static_cast<std::int32_t>(scan.points.size());
    scan.points.push_back(point);
  }
  return scan;
}

TEST(Preprocess, TheRangeGateIsOpenAtBothEndsAndRefusesWhatIsNotFinite) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinite = std::numeric_limits<float>::infinity();
  Config config;
  config.min_range_m = 1.0;
  config.max_range_m = 10.0;
  const Scan scan = scan_of({{1, 0, 0},
                             {1.01F, 0, 0},
                             {0, 9.99F, 0},
                             {0, 0, 10},
                             {0, 0, 0},
                             {kNan, 2, 2},
                             {kInfinite, 0, 0}},
                            100);
  const estimation::ScanTimes times = estimation::times_of(scan, Time{0});
  const auto kept = preprocess(scan, times, Vector6::Zero(), config, Parallel(1));
  ASSERT_EQ(kept.size(), 2U);
  EXPECT_EQ(kept.positions[0], Eigen::Vector3f(1.01F, 0, 0));
  EXPECT_EQ(kept.positions[1], Eigen::Vector3f(0, 9.99F, 0));
  EXPECT_TRUE(kept.deskewed());
}

TEST(Preprocess, APoseBelongsToTheLastPointOrTheMiddleOfTheScan) {
  Scan scan = scan_of({{1, 0, 0}, {1, 0, 0}, {1, 0, 0}}, 300);
  std::swap(scan.points[0], scan.points[2]);  // not in order of time
  EXPECT_EQ(pose_time(estimation::times_of(scan, Time{5}), PoseInstant::kScanEnd), Time{1600});
  EXPECT_EQ(pose_time(estimation::times_of(scan, Time{5}), PoseInstant::kScanMiddle), Time{1300});
  EXPECT_TRUE(estimation::times_of(scan, Time{5}).timed);
  scan.points.clear();
  EXPECT_EQ(pose_time(estimation::times_of(scan, Time{500}), PoseInstant::kScanEnd), Time{1500});
  EXPECT_FALSE(estimation::times_of(scan, Time{500}).timed);
}

TEST(Preprocess, EqualTimesLoseTheScanInTheOriginalAndMeanNoTimesWhenCured) {
  const Scan scan = scan_of({{2, 0, 0}, {3, 0, 0}}, 0);
  const estimation::ScanTimes times = estimation::times_of(scan, Time{0});
  Config config;
  const Pose motion = pose_of(0.1, 0, 0, 0, 0, 0.1);
  const Vector6 twist = twist_within(times, motion, 0.1, config);
  EXPECT_EQ(twist, Vector6::Zero());
  EXPECT_EQ(preprocess(scan, times, twist, config, Parallel(1)).size(), 0U);
  config.ignore_equal_times = true;
  EXPECT_EQ(preprocess(scan, times, twist, config, Parallel(1)).size(), 2U);
}

TEST(Preprocess, MotionFillsTheScanInTheOriginalAndTheTimeItTookWhenCured) {
  const Scan scan = scan_of({{2, 0, 0}, {2, 0, 0}}, 50'000'000);  // a scan of 0.05 s
  const estimation::ScanTimes times = estimation::times_of(scan, Time{0});
  const Vector6 moved = vector6(0.2, 0, 0, 0, 0, 0.1);  // in 0.1 s
  Config config;
  EXPECT_LT((twist_within(times, se3::exp(moved), 0.1, config) - moved / 0.05).norm(), 1e-12);
  config.motion_per_second = true;
  EXPECT_LT((twist_within(times, se3::exp(moved), 0.1, config) - moved / 0.1).norm(), 1e-12);
  config.deskew = false;
  EXPECT_EQ(twist_within(times, se3::exp(moved), 0.1, config), Vector6::Zero());
}

TEST(Preprocess, PointsWhoseMotionIsToBeEstimatedStayAtTheirInstantsUntilItIsKnown) {
  const Scan scan = scan_of({{2, 0, 0}, {3, 0, 0}, {4, 0, 0}}, 50'000'000);
  const estimation::ScanTimes times = estimation::times_of(scan, Time{0});
  Config config;
  config.scan_motion_share = 1.0;
  const Vector6 wrong = vector6(9, 9, 9, 9, 9, 9);
  const TimedPoints points = preprocess(scan, times, wrong, config, Parallel(1));
  ASSERT_EQ(points.seconds, (std::vector<float>{-0.1F, -0.05F, 0.0F}));
  EXPECT_EQ(points.positions[1], scan.points[1].position);
  // at 1 m/s along x, a point measured 0.1 s before the end is 0.1 m nearer at the end
  const auto still = deskewed(points, vector6(1, 0, 0, 0, 0, 0), Parallel(1));
  EXPECT_NEAR(still[0].x(), 1.9F, 1e-6F);
  EXPECT_NEAR(still[1].x(), 2.95F, 1e-6F);
  EXPECT_NEAR(still[2].x(), 4.0F, 1e-6F);
}

TEST(Preprocess, ThinningTakesTheTimesAlong) {
  const TimedPoints points{{{0.1F, 0, 0}, {0.2F, 0, 0}, {5.1F, 0, 0}}, {-3.0F, -2.0F, -1.0F}};
  const TimedPoints thinned = thin(points, 1.0, {});
  ASSERT_EQ(thinned.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_EQ(thinned.seconds[i], thinned.positions[i].x() < 1.0F ? -3.0F : -1.0F);
}

TEST(Preprocess, SlicesAreThePartsOfTheScanInOrderOfTime) {
  Scan scan;
  scan.stamp = Time{5000};
  for (const std::int32_t dt : {900, 0, 100, 399, 400, 450, 1000})  // none in 600 ... 799
    scan.points.emplace_back().dt_ns = dt;
  const auto slices = sliced(scan, 5);
  std::vector<std::vector<std::int32_t>> times;
  for (const Scan& slice : slices) {
    EXPECT_EQ(slice.stamp, scan.stamp);
    EXPECT_TRUE(slice.timed);
    times.emplace_back();
    for (const Point& point : slice.points) times.back().push_back(point.dt_ns);
  }
  EXPECT_EQ(times,
            (std::vector<std::vector<std::int32_t>>{{0, 100}, {399, 400}, {450}, {900, 1000}}))
      << "1000 ns in five: 201 ns each, so that the last point is included";
}

TEST(Preprocess, AScanWithoutTimesOrPointsIsOneSlice) {
  Scan scan = scan_of({{1, 0, 0}, {2, 0, 0}}, 0);
  EXPECT_EQ(sliced(scan, 4).size(), 1U);
  scan.points[1].dt_ns = 1000;
  scan.timed = false;
  EXPECT_EQ(sliced(scan, 4).size(), 1U);
  scan.points.clear();
  EXPECT_EQ(sliced(scan, 4).size(), 1U);
}

}  // namespace
}  // namespace lidarena::odometry::kiss_icp
