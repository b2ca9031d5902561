// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_slam/arena_slam.hpp"

#include <gtest/gtest.h>

#include "tests/odometry/synthetic_room.hpp"

namespace lidarena::odometry::arena_slam {
namespace {

std::vector<ScanResult> results_of(const synthetic::Recording& recording, Config config) {
  const Rig rig = synthetic::rig_of(recording);
  config.min_range_m = rig.lidars[0].min_range_m;
  ArenaSlam odometry(config, rig.lidars[0], rig.imus[0], Parallel(1));
  std::vector<ScanResult> results;
  for (const dataset::Event& event : synthetic::record(recording)) {
    if (const auto* scan = std::get_if<Scan>(&event.data)) {
      results.push_back(odometry.register_scan(*scan));
    } else {
      odometry.register_imu(std::get<ImuSample>(event.data));
    }
  }
  return results;
}

TEST(ArenaSlam, StandingStillNothingGrows) {
  const synthetic::Recording still{.motion = [](double) { return synthetic::flight(0.0); }};
  EXPECT_EQ(results_of(still, {}).back().counters.keyframes, 1U);
}

TEST(ArenaSlam, UsesAndTellsTheMotionWithinEachScan) {
  const synthetic::Recording recording;
  const std::vector<ScanResult> results = results_of(recording, {});
  ASSERT_EQ(results.size(), 40U);
  for (const ScanResult& result : results) {
    if (result.status == ScanStatus::kInitializing) continue;
    ASSERT_GE(result.motion.size(), 2U);
    EXPECT_EQ(result.motion.front().stamp, result.estimate.stamp);
    EXPECT_LT(
        (result.motion.front().world_from_body.matrix() - result.estimate.world_from_body.matrix())
            .norm(),
        1e-9);
    const StampedPose& last = result.motion.back();
    const Pose within = result.estimate.world_from_body.inverse() * last.world_from_body;
    const Pose truth = synthetic::truth(recording, result.estimate.stamp, last.stamp);
    // 0.1 s with a velocity known to 5 cm/s
    EXPECT_LT((within.translation() - truth.translation()).norm(), 5e-3);
  }
}

TEST(ArenaSlam, WithoutPointTimesThereIsNoMotionWithinTheScan) {
  const synthetic::Recording recording;
  const Rig rig = synthetic::rig_of(recording);
  ArenaSlam odometry(settings_for(rig.lidars[0]), rig.lidars[0], rig.imus[0], Parallel(1));
  for (const dataset::Event& event : synthetic::record(recording)) {
    if (const auto* timed = std::get_if<Scan>(&event.data)) {
      Scan scan = *timed;
      scan.timed = false;
      for (Point& point : scan.points) point.dt_ns = 0;
      EXPECT_TRUE(odometry.register_scan(scan).motion.empty());
    } else {
      odometry.register_imu(std::get<ImuSample>(event.data));
    }
  }
}

TEST(ArenaSlam, WithoutImuEveryScanSaysSo) {
  const Rig rig = synthetic::rig_of({});
  ArenaSlam odometry(settings_for(rig.lidars[0]), rig.lidars[0], rig.imus[0], Parallel(1));
  for (const Scan& scan : synthetic::scans_of({.seconds = 0.3}))
    EXPECT_EQ(odometry.register_scan(scan).status, ScanStatus::kInitializing);
  EXPECT_TRUE(odometry.map().empty());
}

}  // namespace
}  // namespace lidarena::odometry::arena_slam
