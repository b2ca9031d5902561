// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/kiss_icp/kiss_icp.hpp"

#include <gtest/gtest.h>

#include "lidarena/base/so3.hpp"
#include "tests/odometry/synthetic_room.hpp"

namespace lidarena::odometry::kiss_icp {
namespace {

using synthetic::Motion;
using synthetic::Recording;

/// Rests for 1 s, then moves along x, from 2 s on at 1.5 m/s.
Pose straight(double seconds) {
  const double moving = std::max(0.0, seconds - 1.0);
  const double x = moving < 1.0 ? 0.75 * moving * moving : 1.5 * (moving - 0.5);
  return make_pose(Eigen::Matrix3d::Identity(), {-3.0 + x, 0.5, 0.0});
}

Recording along_the_straight() { return {.motion = straight, .seconds = 3.0, .repeating = false}; }

KissIcp made(const Config& config, const Recording& recording) {
  return {config, synthetic::rig_of(recording).lidars.front(), Parallel(1)};
}

/// An empty scan, `periods` scans after the last of `scans`: its estimate is the prediction.
Scan empty_scan(const std::vector<Scan>& scans, int periods) {
  Scan empty;
  empty.stamp = scans.back().stamp + periods * from_seconds(0.1);
  return empty;
}

TEST(KissIcp, AfterADroppedScanTheOriginalPredictsOneMotionAndTheCuredOneTwo) {
  const Recording recording = along_the_straight();
  const std::vector<Scan> scans = synthetic::scans_of(recording);
  for (const bool per_second : {false, true}) {
    Config config;
    config.motion_per_second = per_second;
    KissIcp odometry = made(config, recording);
    for (const Scan& scan : scans) odometry.register_scan(scan);
    const auto poses = odometry.trajectory();
    const Pose& last = poses.poses()[poses.size() - 1].world_from_body;
    const Pose motion = poses.poses()[poses.size() - 2].world_from_body.inverse() * last;
    const Pose predicted = odometry.register_scan(empty_scan(scans, 2)).estimate.world_from_body;
    const Pose expected = last * motion * (per_second ? motion : Pose::Identity());
    EXPECT_LT((predicted.matrix() - expected.matrix()).norm(), 1e-9);
    ASSERT_NEAR(motion.translation().norm(), 0.15, 0.1);
  }
}

TEST(KissIcp, WithoutPointsTheOriginalCoastsOnAndTheCuredOneComesToRest) {
  const Recording recording = along_the_straight();
  const std::vector<Scan> scans = synthetic::scans_of(recording);
  for (const double kept : {1.0, 0.5}) {
    Config config;
    config.lost_motion_factor = kept;
    KissIcp odometry = made(config, recording);
    for (const Scan& scan : scans) odometry.register_scan(scan);
    const auto poses = odometry.trajectory();
    Pose expected = poses.poses()[poses.size() - 1].world_from_body;
    se3::Vector6 step =
        se3::log(poses.poses()[poses.size() - 2].world_from_body.inverse() * expected);
    for (int i = 1; i <= 10; ++i, step *= kept) {
      expected = expected * se3::exp(step);
      const ScanResult result = odometry.register_scan(empty_scan(scans, i));
      EXPECT_EQ(result.status, ScanStatus::kTooFewPoints);
      EXPECT_LT((result.estimate.world_from_body.matrix() - expected.matrix()).norm(), 1e-9);
    }
  }
}

TEST(KissIcp, MotionWithinTheScanRunsThroughTheEstimate) {
  for (const PoseInstant instant : {PoseInstant::kScanEnd, PoseInstant::kScanMiddle}) {
    Config config;
    config.pose_instant = instant;
    const Recording recording{.seconds = 3.0};
    KissIcp odometry = made(config, recording);
    ScanResult result;
    for (const Scan& scan : synthetic::scans_of(recording)) result = odometry.register_scan(scan);
    ASSERT_EQ(result.motion.size(), 5U);
    const auto& at = instant == PoseInstant::kScanEnd ? result.motion[4] : result.motion[2];
    EXPECT_LE(std::abs((at.stamp - result.estimate.stamp).count()), 1);
    EXPECT_LT((at.world_from_body.matrix() - result.estimate.world_from_body.matrix()).norm(),
              1e-8);
    EXPECT_GT((result.motion[4].world_from_body.translation() -
               result.motion[0].world_from_body.translation())
                  .norm(),
              0.03);
  }
}

TEST(KissIcp, StartingInMotionTheFirstScanIsMendedByTheSecond) {
  // 1.5 m/s from the first point on: the first scan is distorted by 15 cm
  const Motion moving = [](double t) {
    return make_pose(Eigen::Matrix3d::Identity(), {-3.0 + 1.5 * t, 0.5, 0.0});
  };
  const Recording recording{.motion = moving, .seconds = 0.4, .repeating = false};
  const auto error_at_the_end = [&](bool rebuild) {
    Config config;
    config.voxel_size_m = 0.5;
    config.scan_motion_share = 1.0;
    config.redeskew_first_scan = rebuild;
    KissIcp odometry = made(config, recording);
    for (const Scan& scan : synthetic::scans_of(recording)) odometry.register_scan(scan);
    const auto poses = odometry.trajectory();
    const StampedPose& first = poses.poses().front();
    const StampedPose& last = poses.poses().back();
    const Pose truth = synthetic::truth(recording, first.stamp, last.stamp);
    return (last.world_from_body.translation() - truth.translation()).norm();
  };
  const double as_measured = error_at_the_end(false);
  const double mended = error_at_the_end(true);
  EXPECT_LT(mended, 0.06);
  EXPECT_LT(mended, as_measured);
}

TEST(KissIcp, ScansAreCutOnlyAfterTheCalmStartAndWhileSigmaIsLarge) {
  const Recording recording{.seconds = 1.0};
  const std::vector<Scan> scans = synthetic::scans_of(recording);
  const auto poses_within = [&](double slice_above) {
    Config config;
    config.slices = 2;
    config.slice_above_m = slice_above;
    config.initial_scans = 4;
    config.scan_motion_share = 0.5;
    KissIcp odometry = made(config, recording);
    std::vector<std::size_t> counts;
    for (const Scan& scan : scans) counts.push_back(odometry.register_scan(scan).motion.size());
    return counts;
  };
  const auto cut = poses_within(0.0);
  EXPECT_EQ(cut[3], 5U) << "whole: five poses";
  EXPECT_EQ(cut[4], 10U) << "two parts of five each";
  EXPECT_EQ(poses_within(100.0)[4], 5U) << "sigma is 2 m at most";
}

TEST(KissIcp, APatternThatRepeatsHoldsTheSensorUnlessItsLinesAreLeftOut) {
  // Motion on a straight line without rotation, with the same beam directions in every scan: the
  // rings match best at the sensor's previous pose.
  Recording recording = along_the_straight();
  recording.repeating = true;
  const auto error_with = [&](double weight) {
    Config config = indoor(synthetic::rig_of(recording).lidars.front());
    config.degenerate_cell_weight = weight;
    KissIcp odometry = made(config, recording);
    for (const Scan& scan : synthetic::scans_of(recording)) odometry.register_scan(scan);
    const auto poses = odometry.trajectory();
    const StampedPose& first = poses.poses().front();
    const StampedPose& last = poses.poses().back();
    const Pose truth = synthetic::truth(recording, first.stamp, last.stamp);
    return (last.world_from_body.translation() - truth.translation()).norm();
  };
  EXPECT_GT(error_with(1.0), 1.0) << "of 2 m";
  EXPECT_LT(error_with(1e-4), 0.05);
}

TEST(KissIcp, OfAScanOnePointACellIsRegisteredAndOneASmallerCellIsKept) {
  // A lattice of 10 cm on a wall of 4 x 4 m: cells of 20 cm leave 20 x 20 points for the map, and
  // cells of 40 cm leave 10 x 10 keypoints of these.
  Scan scan;
  scan.timed = false;
  for (int i = 0; i < 1600; ++i) {
    Point& point = scan.points.emplace_back();
    point.position = {3.05F, 0.05F + 0.1F * static_cast<float>(i % 40),
                      0.05F + 0.1F * static_cast<float>(i / 40)};
  }
  Config config;
  config.voxel_size_m = 0.8;
  config.map_thinning = 0.25;
  config.keypoint_thinning = 0.5;
  config.min_spacing = false;
  KissIcp odometry = made(config, {});
  const ScanResult result = odometry.register_scan(scan);
  EXPECT_EQ(result.counters.points, 1600U);
  EXPECT_EQ(result.counters.map_points, 400U);
  EXPECT_EQ(result.counters.keypoints, 100U);
}

TEST(KissIcp, UntimedScansAreTrackedWithoutDeskewing) {
  const Recording recording = along_the_straight();
  KissIcp odometry = made({}, recording);
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
