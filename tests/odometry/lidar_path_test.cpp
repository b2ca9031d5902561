// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/lidar_path.hpp"

#include <gtest/gtest.h>

#include "lidarena/base/so3.hpp"

namespace lidarena::odometry {
namespace {

LidarInfo turned_lidar() {
  LidarInfo lidar;
  lidar.rate_hz = 5.0;
  lidar.body_from_lidar = make_pose(so3::exp({0.0, 0.0, 1.5707963267948966}), {0.0, 0.0, 0.1});
  return lidar;
}

Scan empty_at(double seconds) {
  Scan scan;
  scan.stamp = from_seconds(seconds);
  return scan;
}

Scan timed_at(double seconds) {
  Scan scan = empty_at(seconds);
  scan.timed = true;
  scan.points.resize(2);
  scan.points[1].dt_ns = 50'000'000;
  return scan;
}

TEST(LidarPath, IsThatOfTheBodyThatCarriesTheLidar) {
  LidarPath path(turned_lidar());
  const Scan scan = timed_at(1.0);
  const estimation::ScanTimes times = path.times_of(scan);
  path.add(make_pose(Eigen::Matrix3d::Identity(), {1.0, 0.0, 0.0}), times.last, times);
  ASSERT_EQ(path.poses().size(), 1U);
  EXPECT_EQ(path.poses()[0].stamp, from_seconds(1.05));
  EXPECT_TRUE(
      path.poses()[0].world_from_body.translation().isApprox(Eigen::Vector3d(0, 1, 0), 1e-12))
      << "the lidar's x axis is the body's y axis";
  EXPECT_TRUE(path.body_pose(Pose::Identity()).isApprox(Pose::Identity(), 1e-12));
}

TEST(LidarPath, EmptyScansLastAsLongAsTheLastOneThatHadTimes) {
  LidarPath path(turned_lidar());
  EXPECT_EQ(path.times_of(empty_at(1.0)).last, from_seconds(1.2)) << "nominal: 5 Hz";
  const estimation::ScanTimes times = path.times_of(timed_at(2.0));
  path.add(Pose::Identity(), times.last, times);
  EXPECT_EQ(path.times_of(empty_at(3.0)).last, from_seconds(3.05));
}

}  // namespace
}  // namespace lidarena::odometry
