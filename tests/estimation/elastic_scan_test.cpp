// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/elastic_scan.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "lidarena/base/so3.hpp"

namespace lidarena::estimation {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Scan scan_of(std::vector<Point> points, bool timed = true) {
  return {Time{1'000'000'000}, std::move(points), timed};
}

TEST(ElasticScan, AlphaRunsFromTheEarliestPointToTheLatestAndBadPointsAreDropped) {
  const Scan scan = scan_of({{{1, 0, 0}, 0, 500},
                             {{2, 0, 0}, 0, 100},
                             {{3, 0, 0}, 0, 200},
                             {{kNan, 0, 0}, 0, 300},
                             {{0.1F, 0, 0}, 0, 300},
                             {{60, 0, 0}, 0, 300}});
  const ScanTimes times = times_of(scan, Time{77});
  EXPECT_EQ(times.first - scan.stamp, Time{100});
  EXPECT_EQ(times.last - scan.stamp, Time{500});
  EXPECT_TRUE(times.timed);
  const RangeGate gate{0.5, 50.0};
  const auto points = timed_points(scan, times, false, gate);
  ASSERT_EQ(points.size(), 3U);
  EXPECT_EQ(points[0].alpha, 1.0F);
  EXPECT_EQ(points[1].alpha, 0.0F);
  EXPECT_EQ(points[2].alpha, 0.25F);
  for (const TimedPoint& point : timed_points(scan, times, true, gate))
    EXPECT_EQ(point.alpha, 1.0F) << "rigid";
}

TEST(ElasticScan, AnUnlimitedGateDropsWhatIsNotFiniteOnly) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const Scan scan = scan_of({{{0, 0, 0}, 0, 0},
                             {{1e30F, 0, 0}, 0, 100},
                             {{0, -kInfinity, 0}, 0, 200},
                             {{0, 0, kNan}, 0, 300}});
  const RangeGate gate{0.0, std::numeric_limits<double>::infinity()};
  EXPECT_EQ(timed_points(scan, times_of(scan, Time{77}), false, gate).size(), 2U);
}

TEST(ElasticScan, AnEmptyScanLastsAsUsualAndOneWithoutTimesIsNotTimed) {
  const ScanTimes empty = times_of(scan_of({}), Time{77});
  EXPECT_EQ(empty.last - empty.first, Time{77});
  EXPECT_FALSE(empty.timed);
  EXPECT_FALSE(times_of(scan_of({{{1, 0, 0}, 0, 0}, {{2, 0, 0}, 0, 0}}), Time{77}).timed);
  EXPECT_FALSE(times_of(scan_of({{{1, 0, 0}, 0, 0}, {{2, 0, 0}, 0, 9}}, false), Time{77}).timed);
}

TEST(ElasticScan, BodyPosesAreThoseOfABodyOnWhichTheLidarIsMounted) {
  const Pose body_from_lidar = make_pose(so3::exp({0, 0, 0.5}), {0.2, 0, 0});
  const Pose step = make_pose(so3::exp({0, 0, 0.1}), {1, 0, 0});
  const ElasticMotion lidar{{Pose::Identity(), step, step * step}};
  const ScanTimes times{Time{100}, Time{300}, true};
  const auto poses = body_poses(lidar, times, body_from_lidar);
  ASSERT_EQ(poses.size(), 3U);
  EXPECT_EQ(poses[1].stamp, Time{200});
  EXPECT_TRUE(poses[0].world_from_body.isApprox(Pose::Identity(), 1e-12));
  // where a point of the lidar is does not depend on the way it is computed
  const Eigen::Vector3d point(3, 2, 1);
  const std::vector<TimedPoint> points{{point.cast<float>(), 1.0F}};
  const auto world = placed(moved(body_from_lidar, lidar), points, Parallel(1));
  const Eigen::Vector3d expected = poses[2].world_from_body * body_from_lidar * point;
  EXPECT_LT((world[0].cast<double>() - expected).norm(), 1e-6);
}

TEST(ElasticScan, AConstantTwistPassesThroughTheKnownPose) {
  const Pose known = make_pose(so3::exp({0, 0, 0.3}), {1, 2, 3});
  se3::Vector6 twist;
  twist << 2.0, 0, 0, 0, 0, 0.5;
  const ScanTimes times{from_seconds(1.0), from_seconds(1.4), true};
  const ElasticMotion motion = constant_twist_motion({from_seconds(1.2), known}, twist, times, 4);
  ASSERT_EQ(motion.segments(), 4U);
  EXPECT_TRUE(motion.knots[2].isApprox(known, 1e-12));
  EXPECT_TRUE(motion.end().isApprox(known * se3::exp(0.2 * twist), 1e-12));
}

}  // namespace
}  // namespace lidarena::estimation
