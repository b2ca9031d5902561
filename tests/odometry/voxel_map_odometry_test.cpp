// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/voxel_map_odometry.hpp"

#include <gtest/gtest.h>

#include "lidarena/base/so3.hpp"
#include "lidarena/estimation/deskew.hpp"

namespace lidarena::odometry {
namespace {

LidarInfo turned_lidar() {
  LidarInfo lidar;
  lidar.rate_hz = 5.0;
  lidar.body_from_lidar = make_pose(so3::exp({0.0, 0.0, 1.5707963267948966}), {0.0, 0.0, 0.1});
  return lidar;
}

/// Moves by 1 m along the lidar's x axis in each scan, whose points are the map.
class MapWalker : public VoxelMapOdometry {
 public:
  MapWalker() : VoxelMapOdometry("walker", turned_lidar(), {1.0, 10, 0.0}, Parallel(1)) {}
  ScanResult register_scan(const Scan& scan) override {
    const estimation::ScanTimes times = times_of(scan);
    if (is_out_of_order(times.last)) return unchanged(ScanStatus::kTooFewPoints, {.points = 7});
    map_.insert(estimation::positions(scan));
    store(make_pose(Eigen::Matrix3d::Identity(), {++meters_, 0.0, 0.0}), times.last, times);
    return {poses_.back(), ScanStatus::kTracked, std::nullopt, {}, {}};
  }

 private:
  double meters_ = 0.0;
};

Scan empty_at(double seconds) {
  Scan scan;
  scan.stamp = from_seconds(seconds);
  return scan;
}

TEST(VoxelMapOdometry, TellsThePosesAndTheMapOfTheBody) {
  MapWalker walker;
  Scan scan = empty_at(1.0);
  scan.timed = true;
  scan.points.resize(2);
  scan.points[0].position = {3.0F, 0.0F, 0.0F};
  scan.points[1].position = {5.0F, 0.0F, 0.0F};
  scan.points[1].dt_ns = 50'000'000;
  const ScanResult found = walker.register_scan(scan);
  EXPECT_EQ(found.estimate.stamp, from_seconds(1.05));
  EXPECT_TRUE(
      found.estimate.world_from_body.translation().isApprox(Eigen::Vector3d(0, 1, 0), 1e-12))
      << "the lidar's x axis is the body's y axis";
  const auto map = walker.map();
  ASSERT_EQ(map.size(), 2U);
  EXPECT_NEAR(map[0].y() + map[1].y(), 3.0F + 5.0F, 1e-5F) << "in any order";
  EXPECT_NEAR(map[0].x(), 0.0F, 1e-5F);
  EXPECT_NEAR(map[0].z(), 0.1F, 1e-6F);
  EXPECT_GT(walker.memory().at("map"), 0U);
}

TEST(VoxelMapOdometry, EmptyScansLastAsLongAsTheLastOneThatHadTimes) {
  MapWalker walker;
  EXPECT_EQ(walker.register_scan(empty_at(1.0)).estimate.stamp, from_seconds(1.2))
      << "nominal: 5 Hz";
  Scan scan = empty_at(2.0);
  scan.timed = true;
  scan.points.resize(2);
  scan.points[1].dt_ns = 50'000'000;
  walker.register_scan(scan);
  EXPECT_EQ(walker.register_scan(empty_at(3.0)).estimate.stamp, from_seconds(3.05));
}

TEST(VoxelMapOdometry, AScanThatIsNotLaterChangesNothing) {
  MapWalker walker;
  walker.register_scan(empty_at(1.0));
  const ScanResult again = walker.register_scan(empty_at(1.0));
  EXPECT_EQ(again.status, ScanStatus::kTooFewPoints);
  EXPECT_EQ(again.counters.points, 7U);
  EXPECT_EQ(again.estimate.stamp, from_seconds(1.2));
  EXPECT_EQ(walker.trajectory().size(), 1U);
}

}  // namespace
}  // namespace lidarena::odometry
