// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/ct_icp/ct_icp.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "lidarena/base/so3.hpp"
#include "tests/odometry/synthetic_room.hpp"

namespace lidarena::odometry::ct_icp {
namespace {

using synthetic::Recording;

LidarInfo lidar() { return synthetic::rig_of({}).lidars[0]; }

TEST(CtIcp, AScanWithoutTimesIsRigidAndHasNoMotionWithin) {
  const Recording recording{.motion = [](double) { return synthetic::flight(0.0); },
                            .seconds = 0.5};
  for (const Config& config : {indoor(lidar()), published(lidar())}) {
    CtIcp odometry(config, lidar(), Parallel(1));
    for (Scan scan : synthetic::scans_of(recording)) {
      scan.timed = false;
      for (Point& point : scan.points) point.dt_ns = 0;
      const ScanResult result = odometry.register_scan(scan);
      EXPECT_NE(result.status, ScanStatus::kDiverged);
      EXPECT_TRUE(result.motion.empty());
      EXPECT_LT(result.estimate.world_from_body.translation().norm(), 0.02) << "at rest";
    }
  }
}

TEST(CtIcp, TheFirstTwoScansAreRigid) {
  CtIcp odometry(indoor(lidar()), lidar(), Parallel(1));
  int index = 0;
  for (const Scan& scan : synthetic::scans_of({.seconds = 0.5})) {
    const ScanResult result = odometry.register_scan(scan);
    EXPECT_EQ(result.motion.size(), index < 2 ? 0U : 2U) << index;
    ++index;
  }
}

/// Rests for 0.5 s, then yaws at the given rate.
std::vector<Scan> yawing(double degrees_per_second) {
  const auto motion = [=](double t) {
    const double angle = std::max(0.0, t - 0.5) * degrees_per_second * M_PI / 180.0;
    return make_pose(so3::exp({0, 0, angle}), Eigen::Vector3d::Zero());
  };
  return synthetic::scans_of({.motion = motion, .seconds = 1.5});
}

TEST(CtIcp, ScansThatTurnFastAreLeftOutOfTheMapUnlessAllAreWanted) {
  for (const bool all : {false, true}) {
    Config config = indoor(lidar());
    config.map.always_insert = all;
    CtIcp odometry(config, lidar(), Parallel(1));
    int inserted = 0;
    for (const Scan& scan : yawing(60.0))
      inserted += odometry.register_scan(scan).detail("inserted").value() != 0.0 ? 1 : 0;
    // 5 scans at rest, then 10 at 6 degrees each, of which the seventh is taken in any case
    EXPECT_EQ(inserted, all ? 15 : 6);
  }
}

TEST(CtIcp, AfterAFailedRegistrationItHasEndedLikeThePublishedProgram) {
  std::vector<Scan> scans = synthetic::scans_of({.seconds = 1.0});
  scans[6].points.resize(10);  // fewer than 20 matches
  CtIcp odometry(indoor(lidar()), lidar(), Parallel(1));
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const ScanStatus status = odometry.register_scan(scans[i]).status;
    EXPECT_EQ(status == ScanStatus::kDiverged, i >= 6) << i;
  }
  EXPECT_EQ(odometry.trajectory().size(), 6U);
  EXPECT_EQ(odometry.trajectory().poses().back().stamp,
            estimation::times_of(scans[5], Time{0}).last);
}

TEST(CtIcp, ARotationBeyondThirtyDegreesEndsItToo) {
  CtIcp odometry(indoor(lidar()), lidar(), Parallel(1));
  ScanStatus status = ScanStatus::kInitializing;
  for (const Scan& scan : yawing(400.0)) status = odometry.register_scan(scan).status;
  EXPECT_EQ(status, ScanStatus::kDiverged);
}

TEST(CtIcp, ARotationWithinTheConfiguredLimitDoesNot) {
  Config config = indoor(lidar());
  config.registration.max_rotation_deg = 120.0;
  config.map.always_insert = true;
  CtIcp odometry(config, lidar(), Parallel(1));
  for (const Scan& scan : yawing(400.0))
    EXPECT_NE(odometry.register_scan(scan).status, ScanStatus::kDiverged);
}

}  // namespace
}  // namespace lidarena::odometry::ct_icp
