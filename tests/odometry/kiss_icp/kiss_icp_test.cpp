// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/kiss_icp/kiss_icp.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "lidarena/base/so3.hpp"
#include "lidarena/odometry/kiss_icp_head/kiss_icp_head.hpp"
#include "tests/odometry/synthetic_room.hpp"

namespace lidarena::odometry::kiss_icp {
namespace {

using synthetic::Recording;

using kiss_icp_head::KissIcpHead;

/// Rests for 1 s, then moves along x, from 2 s on at 1.5 m/s.
Pose straight(double seconds) {
  const double moving = std::max(0.0, seconds - 1.0);
  const double x = moving < 1.0 ? 0.75 * moving * moving : 1.5 * (moving - 0.5);
  return make_pose(Eigen::Matrix3d::Identity(), {-3.0 + x, 0.5, 0.0});
}

Recording along_the_straight() { return {.motion = straight, .seconds = 3.0, .repeating = false}; }

template <class Method>
Method made(const Config& config, const Recording& recording) {
  return {config, synthetic::rig_of(recording).lidars.front(), Parallel(1)};
}

/// What both releases, v0.2 and that of late 2025, do alike.
template <class Method>
struct KissIcpReleases : ::testing::Test {};
using Releases = ::testing::Types<KissIcp, KissIcpHead>;
TYPED_TEST_SUITE(KissIcpReleases, Releases);

/// `scan` with all points at the same time, `periods` scans later.
Scan with_equal_times(Scan scan, int periods) {
  scan.stamp += periods * from_seconds(0.1);
  for (Point& point : scan.points) point.dt_ns = 50'000'000;
  return scan;
}

TEST(KissIcp, PresetsAreValuesOfTheProgramsParameters) {
  const LidarInfo lidar;
  const Config shipped = published(lidar);
  EXPECT_EQ(shipped.voxel_size(), 1.0);
  EXPECT_EQ(shipped.min_range_m, 5.0);
  EXPECT_FALSE(shipped.deskew);
  const Config latest = kiss_icp_head::published(lidar);
  EXPECT_EQ(latest.voxel_size(), 1.0);
  EXPECT_EQ(latest.min_range_m, 0.0);
  EXPECT_TRUE(latest.deskew);
  const Config rooms = indoor(lidar);
  EXPECT_EQ(rooms.voxel_size(), 0.5) << "a hundredth of the maximum range";
  EXPECT_EQ(rooms.min_range_m, 0.0);
  EXPECT_TRUE(rooms.deskew);
}

TYPED_TEST(KissIcpReleases, WithoutPointsItCoastsOnByOneMotionForEachScan) {
  const Recording recording = along_the_straight();
  const std::vector<Scan> scans = synthetic::scans_of(recording);
  TypeParam odometry = made<TypeParam>(Config{}, recording);
  for (const Scan& scan : scans) odometry.register_scan(scan);
  const auto poses = odometry.trajectory();
  Pose expected = poses.poses()[poses.size() - 1].world_from_body;
  const Pose motion = poses.poses()[poses.size() - 2].world_from_body.inverse() * expected;
  ASSERT_NEAR(motion.translation().norm(), 0.15, 0.1);
  Scan empty;
  for (const int period : {1, 2, 4, 5}) {  // the program does not see that a scan was dropped
    expected = expected * motion;
    empty.stamp = scans.back().stamp + period * from_seconds(0.1);
    const ScanResult result = odometry.register_scan(empty);
    EXPECT_EQ(result.status, ScanStatus::kTooFewPoints);
    EXPECT_LT((result.estimate.world_from_body.matrix() - expected.matrix()).norm(), 1e-9);
  }
}

TYPED_TEST(KissIcpReleases, MotionWithinTheScanRunsThroughTheEstimate) {
  const Recording recording{.seconds = 3.0};
  TypeParam odometry = made<TypeParam>(Config{}, recording);
  ScanResult result;
  for (const Scan& scan : synthetic::scans_of(recording)) result = odometry.register_scan(scan);
  ASSERT_EQ(result.motion.size(), 5U);
  const auto& at = std::is_same_v<TypeParam, KissIcpHead> ? result.motion[4] : result.motion[2];
  EXPECT_LE(std::abs((at.stamp - result.estimate.stamp).count()), 1);
  EXPECT_LT((at.world_from_body.matrix() - result.estimate.world_from_body.matrix()).norm(), 1e-8);
  EXPECT_GT((result.motion[4].world_from_body.translation() -
             result.motion[0].world_from_body.translation())
                .norm(),
            0.03);
}

TEST(KissIcp, DeskewingStartsWithTheThirdScanInHeadAndWithTheFourthInV02) {
  const Recording recording{
      .motion = [](double t) { return straight(t + 2.0); }, .seconds = 0.5, .repeating = false};
  const std::vector<Scan> scans = synthetic::scans_of(recording);
  const auto first_deskewed = [&](auto odometry) {
    std::size_t number = 1;
    for (const Scan& scan : scans) {
      if (!odometry.register_scan(scan).motion.empty()) return number;
      ++number;
    }
    return std::size_t{0};
  };
  EXPECT_EQ(first_deskewed(made<KissIcpHead>({}, recording)), 3U) << "two scans show a motion";
  EXPECT_EQ(first_deskewed(made<KissIcp>({}, recording)), 4U);
  Config as_measured;
  as_measured.deskew = false;
  EXPECT_EQ(first_deskewed(made<KissIcp>(as_measured, recording)), 0U);
  EXPECT_EQ(first_deskewed(made<KissIcpHead>(as_measured, recording)), 0U);
}

TEST(KissIcp, AScanWhosePointsAllHaveOneTimeIsLostWhileDeskewingAndTold) {
  const Recording recording{.seconds = 1.0};
  const std::vector<Scan> scans = synthetic::scans_of(recording);
  for (const bool deskew : {true, false}) {
    Config config;
    config.deskew = deskew;
    auto odometry = made<KissIcpHead>(config, recording);
    for (const Scan& scan : scans) odometry.register_scan(scan);
    const ScanResult result = odometry.register_scan(with_equal_times(scans.back(), 1));
    EXPECT_EQ(result.status, deskew ? ScanStatus::kTooFewPoints : ScanStatus::kTracked);
    EXPECT_EQ(result.counters.points == 0U, deskew);
    EXPECT_TRUE(result.motion.empty());
    EXPECT_TRUE(result.estimate.world_from_body.matrix().allFinite());
  }
  // v0.2 does not de-skew its first three scans, and so loses none of them
  auto odometry = made<KissIcp>({}, recording);
  for (int i = 0; i < 5; ++i) {
    const ScanStatus status = odometry.register_scan(with_equal_times(scans.front(), i)).status;
    EXPECT_EQ(status, i == 0  ? ScanStatus::kInitializing
                      : i < 3 ? ScanStatus::kTracked
                              : ScanStatus::kTooFewPoints);
  }
}

TYPED_TEST(KissIcpReleases, APatternThatRepeatsHoldsASensorThatDoesNotTurn) {
  // Motion on a straight line with the same beam directions in every scan: the rings on the walls
  // match best at the sensor's previous pose. Both releases stay behind by more than half of the
  // way; the same sensor with other directions in each scan does not.
  for (const bool repeating : {true, false}) {
    Recording recording = along_the_straight();
    recording.repeating = repeating;
    Config config = indoor({});
    TypeParam odometry = made<TypeParam>(config, recording);
    for (const Scan& scan : synthetic::scans_of(recording)) odometry.register_scan(scan);
    const auto poses = odometry.trajectory();
    const StampedPose& last = poses.poses().back();
    const Pose truth = synthetic::truth(recording, poses.begin_time(), last.stamp);
    const double error = (last.world_from_body.translation() - truth.translation()).norm();
    if (repeating) {
      EXPECT_GT(error, 1.0) << "of 2 m";
    } else {
      EXPECT_LT(error, 0.25);
    }
  }
}

TEST(KissIcp, APoseBelongsToTheMiddleOfTheScanInV02AndToTheLastPointInHead) {
  const auto expect_stamps = [](auto odometry, Time of_points, Time of_empty) {
    Scan scan;
    scan.stamp = Time{1000};
    for (const std::int32_t dt_ns : {600, 300, 0}) scan.points.emplace_back().dt_ns = dt_ns;
    EXPECT_EQ(odometry.register_scan(scan).estimate.stamp, of_points) << "not in order of time";
    scan.stamp = Time{3000};
    scan.points.clear();
    EXPECT_EQ(odometry.register_scan(scan).estimate.stamp, of_empty) << "as long as the last";
  };
  expect_stamps(made<KissIcpHead>({}, {}), Time{1600}, Time{3600});
  expect_stamps(made<KissIcp>({}, {}), Time{1300}, Time{3300});
}

TEST(KissIcp, OfAScanOnePointACellIsRegisteredAndOneASmallerCellIsKept) {
  // A lattice of 10 cm on a wall of 4.8 x 4.8 m. Cells of half a voxel, 20 cm, leave 24 x 24
  // points for the map, and cells of one and a half voxels, 60 cm, leave 8 x 8 keypoints of these.
  Scan scan;
  scan.timed = false;
  for (int i = 0; i < 48 * 48; ++i) {
    scan.points.emplace_back().position = {3.05F, 0.05F + 0.1F * static_cast<float>(i % 48),
                                           0.05F + 0.1F * static_cast<float>(i / 48)};
  }
  const auto config_of = [](int max_points) {
    Config config;
    config.voxel_size_m = 0.4;
    config.max_points_per_voxel = max_points;
    return config;
  };
  const auto v0_2 = [&](int max_points) {
    return made<KissIcp>(config_of(max_points), {}).register_scan(scan);
  };
  const auto head = [&](int max_points) {
    return made<KissIcpHead>(config_of(max_points), {}).register_scan(scan);
  };
  const ScanResult all = v0_2(20);
  EXPECT_EQ(all.counters.points, 48U * 48U);
  EXPECT_EQ(all.detail("keypoints"), 64.0);
  EXPECT_EQ(all.detail("map_points"), 576.0) << "four of each map cell of 40 cm";
  EXPECT_EQ(v0_2(3).detail("map_points"), 3.0 * 144.0) << "the first three";
  EXPECT_EQ(head(20).detail("map_points"), 576.0) << "9 cm apart at least";
  EXPECT_EQ(head(3).detail("map_points"), 2.0 * 144.0)
      << "23 cm apart at least: only those on a diagonal";
}

TYPED_TEST(KissIcpReleases, UntimedScansAreTrackedWithoutDeskewing) {
  const Recording recording = along_the_straight();
  TypeParam odometry = made<TypeParam>(Config{}, recording);
  ScanResult result;
  for (Scan scan : synthetic::scans_of(recording)) {
    scan.timed = false;
    for (Point& point : scan.points) point.dt_ns = 0;
    result = odometry.register_scan(scan);
  }
  EXPECT_EQ(result.status, ScanStatus::kTracked);
  EXPECT_TRUE(result.motion.empty());
  EXPECT_EQ(result.estimate.stamp, recording.epoch + from_seconds(2.9));
  // the limit is the distance traveled during a scan, by which an untimed scan is distorted
  const Pose truth = synthetic::truth(recording, recording.epoch, result.estimate.stamp);
  EXPECT_LT((result.estimate.world_from_body.translation() - truth.translation()).norm(), 0.15);
}

}  // namespace
}  // namespace lidarena::odometry::kiss_icp
