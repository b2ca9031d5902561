// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lo/arena_lo.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/odometry/synthetic_room.hpp"

namespace lidarena::odometry::arena_lo {
namespace {

LidarInfo lidar() { return synthetic::rig_of({}).lidars[0]; }

TEST(ArenaLo, AScanWithoutTimesIsRigidAndHasNoMotionWithin) {
  const synthetic::Recording recording{.motion = [](double) { return synthetic::flight(0.0); },
                                       .seconds = 0.5};
  ArenaLo odometry(settings_for(lidar()), lidar(), Parallel(1));
  for (Scan scan : synthetic::scans_of(recording)) {
    scan.timed = false;
    for (Point& point : scan.points) point.dt_ns = 0;
    const ScanResult result = odometry.register_scan(scan);
    EXPECT_NE(result.status, ScanStatus::kTooFewPoints);
    EXPECT_TRUE(result.motion.empty());
    EXPECT_LT(result.estimate.world_from_body.translation().norm(), 0.02) << "at rest";
  }
}

TEST(ArenaLo, AFloorAloneIsDegenerate) {
  ArenaLo odometry(settings_for(lidar()), lidar(), Parallel(1));
  std::vector<Point> points;
  for (int i = 0; i < 4000; ++i) {
    const double radius = 1.0 + 0.002 * i;
    points.push_back({{static_cast<float>(radius * std::cos(2.4 * i)),
                       static_cast<float>(radius * std::sin(2.4 * i)), -1.5F},
                      0,
                      i * 20'000});
  }
  ScanResult result;
  for (int k = 0; k < 3; ++k)
    result = odometry.register_scan({Time{1'000'000'000 + k * 100'000'000LL}, points, true});
  EXPECT_EQ(result.status, ScanStatus::kDegenerate);
}

TEST(ArenaLo, AScanThatCannotBeRegisteredIsPredictedAndLeftOutOfTheMap) {
  std::vector<Scan> scans = synthetic::scans_of({.seconds = 1.5});
  scans[8].points.resize(30);
  ArenaLo odometry(settings_for(lidar()), lidar(), Parallel(1));
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const ScanResult result = odometry.register_scan(scans[i]);
    EXPECT_EQ(result.status == ScanStatus::kTooFewPoints, i == 8) << i;
    EXPECT_EQ(result.counters.inserted.value(), i != 8) << i;
  }
}

TEST(ArenaLo, AScanOutOfOrderIsCountedAndChangesNothing) {
  const std::vector<Scan> scans = synthetic::scans_of({.seconds = 1.0});
  ArenaLo odometry(settings_for(lidar()), lidar(), Parallel(1));
  ArenaLo undisturbed(settings_for(lidar()), lidar(), Parallel(1));
  for (std::size_t i = 0; i < scans.size(); ++i) {
    odometry.register_scan(scans[i]);
    undisturbed.register_scan(scans[i]);
    if (i != 5) continue;
    const ScanResult refused = odometry.register_scan(scans[2]);
    EXPECT_EQ(refused.status, ScanStatus::kTooFewPoints);
    EXPECT_EQ(refused.counters.scans_refused.value(), 1U);
  }
  EXPECT_EQ(odometry.trajectory().poses().back().world_from_body.matrix(),
            undisturbed.trajectory().poses().back().world_from_body.matrix());
}

}  // namespace
}  // namespace lidarena::odometry::arena_lo
