// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/ct_icp/elastic_motion.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "lidarena/base/so3.hpp"
#include "tests/odometry/ct_icp/pose_of.hpp"

namespace lidarena::odometry::ct_icp {
namespace {

using Vector12 = Eigen::Matrix<double, 12, 1>;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// The motion after left increments (translation, rotation about the pose's own position) of begin
/// and end.
ElasticTrack moved_track(const ElasticMotion& motion, const Vector12& d) {
  const auto apply = [](const Pose& pose, const Eigen::Matrix<double, 6, 1>& step) {
    return make_pose(Eigen::Matrix3d(so3::exp(step.tail<3>()) * pose.linear()),
                     Eigen::Vector3d(pose.translation() + step.head<3>()));
  };
  return ElasticTrack({apply(motion.begin, d.head<6>()), apply(motion.end, d.tail<6>())});
}

/// From one fixed pose, turning by `angle` (rad).
ElasticMotion turning(double angle) {
  const Pose begin = pose_of(1, 2, 3, 0.3, -0.2, 1.0);
  const Eigen::Vector3d turn = angle * Eigen::Vector3d(2, -1, 2) / 3.0;
  return {begin, make_pose(Eigen::Matrix3d(so3::exp(turn) * begin.linear()), {1.5, 1, 3})};
}

TEST(CtIcpElasticMotion, IsLinearInPositionAndTurnsEvenly) {
  const ElasticMotion motion{pose_of(1, 2, 3, 0, 0, 0.2), pose_of(2, 2, 5, 0, 0, 0.6)};
  const Pose quarter = motion.at(0.25);
  EXPECT_LT((quarter.translation() - Eigen::Vector3d(1.25, 2, 3.5)).norm(), 1e-14);
  EXPECT_LT((so3::log(quarter.linear()) - Eigen::Vector3d(0, 0, 0.3)).norm(), 1e-14);
  EXPECT_LT((motion.at(1.0).matrix() - motion.end.matrix()).norm(), 1e-14);
  const MotionChange change = change_between(motion, ElasticMotion::still(motion.begin));
  EXPECT_NEAR(change.translation_m, Eigen::Vector3d(1, 0, 2).norm(), 1e-14);
  EXPECT_NEAR(change.rotation_rad, 0.4, 1e-14);
}

TEST(CtIcpElasticMotion, PlacesPointsAsItsInterpolatedPoseDoes) {
  const Eigen::Vector3d point(4.0, -7.0, 1.5);
  for (const double angle : {0.0, 1e-12, 1e-6, 0.01, 0.5, 3.0}) {
    const ElasticMotion motion = turning(angle);
    const ElasticTrack track(motion);
    for (const double alpha : {0.0, 0.1, 0.49, 0.5, 0.77, 1.0})
      // lever of 8 m; the angle is rounded like an arc cosine near one: 1e-8 squared and more
      EXPECT_LT((track.place(point, alpha) - motion.at(alpha) * point).norm(), 1e-11) << angle;
  }
}

TEST(CtIcpElasticMotion, DerivativeIsTheNumericOneAtAnyTurn) {
  const Eigen::Vector3d point(4.0, -7.0, 1.5);
  const Eigen::Vector3d direction = Eigen::Vector3d(1, 2, -2) / 3.0;
  for (const double angle : {0.0, 1e-6, 1e-3, 0.3, 2.0}) {
    const ElasticMotion motion = turning(angle);
    for (const double alpha : {0.0, 0.3, 0.5, 1.0}) {
      const auto row = ElasticTrack(motion).row(point, alpha, direction);
      constexpr double h = 1e-5;
      for (int k = 0; k < 12; ++k) {
        const auto at = [&](double s) {
          return direction.dot(moved_track(motion, s * Vector12::Unit(k)).place(point, alpha));
        };
        const double slope = (at(h) - at(-h)) / (2.0 * h);
        // h^2 / 6 times a third derivative of about 8 m, and rounding of 8 m by 1e-16, over h
        EXPECT_NEAR(row[k], slope, 2e-9) << "angle " << angle << " alpha " << alpha << " k " << k;
      }
    }
  }
}

TEST(CtIcpElasticMotion, AlphaRunsFromTheEarliestPointToTheLatestAndBadPointsAreDropped) {
  const Scan scan{Time{1'000'000'000},
                  {{{1, 0, 0}, 0, 500},
                   {{2, 0, 0}, 0, 100},
                   {{3, 0, 0}, 0, 200},
                   {{kNan, 0, 0}, 0, 300},
                   {{0, -kInfinity, 0}, 0, 300},
                   {{0, 0, 0}, 0, 300}},
                  true};
  const estimation::ScanTimes times = estimation::times_of(scan, Time{77});
  const auto points = timed_points(scan, times, false);
  ASSERT_EQ(points.size(), 4U);
  EXPECT_EQ(points[0].alpha, 1.0F);
  EXPECT_EQ(points[1].alpha, 0.0F);
  EXPECT_EQ(points[2].alpha, 0.25F);
  for (const TimedPoint& point : timed_points(scan, times, true))
    EXPECT_EQ(point.alpha, 1.0F) << "rigid";
}

TEST(CtIcpElasticMotion, BodyPosesAreThoseOfABodyOnWhichTheLidarIsMounted) {
  const Pose body_from_lidar = make_pose(so3::exp({0, 0, 0.5}), {0.2, 0, 0});
  const ElasticMotion lidar{Pose::Identity(), make_pose(so3::exp({0, 0, 0.1}), {1, 0, 0})};
  const auto poses = body_poses(lidar, {Time{100}, Time{300}, true}, body_from_lidar);
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_EQ(poses[0].stamp, Time{100});
  EXPECT_EQ(poses[1].stamp, Time{300});
  EXPECT_TRUE(poses[0].world_from_body.isApprox(Pose::Identity(), 1e-12));
  // where a point of the lidar is does not depend on the way it is computed
  const Eigen::Vector3d point(3, 2, 1);
  const std::vector<TimedPoint> points{{point.cast<float>(), 1.0F}};
  const auto world = placed(body_from_lidar, lidar, points, Parallel(1));
  const Eigen::Vector3d expected = poses[1].world_from_body * body_from_lidar * point;
  EXPECT_LT((world[0].cast<double>() - expected).norm(), 1e-6);
}

}  // namespace
}  // namespace lidarena::odometry::ct_icp
