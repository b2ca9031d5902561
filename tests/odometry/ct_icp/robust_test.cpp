// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/ct_icp/robust.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lidarena/base/angle.hpp"
#include "lidarena/base/so3.hpp"
#include "lidarena/odometry/ct_icp/ct_icp.hpp"
#include "tests/odometry/synthetic_room.hpp"

namespace lidarena::odometry::ct_icp {
namespace {

LidarInfo room_lidar() { return synthetic::rig_of({}).lidars[0]; }

ElasticMotion turned(double degrees, double meters = 0.0) {
  return {Pose::Identity(), make_pose(so3::exp({0, 0, degrees * kDegree}), {meters, 0.0, 0.0})};
}

RobustConfig enabled(int attempts) {
  RobustConfig config;
  config.enabled = true;
  config.attempts = attempts;
  return config;
}

TEST(CtIcpRobust, EachLevelOfCareIsThatOfTheProgram) {
  const SamplingConfig sampling;
  const RegistrationConfig first;
  const Settings once = more_careful({sampling, first}, sampling);
  EXPECT_EQ(once.registration.max_iterations, 28);
  EXPECT_EQ(once.registration.inner_iterations, 50);
  EXPECT_NEAR(once.registration.convergence_rotation_rad, 0.01 * kDegree, 1e-12);
  EXPECT_NEAR(once.registration.convergence_translation_m, 0.001, 1e-12);
  EXPECT_NEAR(once.registration.robust_kernel_scale_m, 0.12, 1e-12);
  EXPECT_NEAR(once.registration.max_plane_distance_m, 0.45, 1e-12);
  EXPECT_NEAR(once.sampling.keypoint_voxel_size_m, 0.4, 1e-12);
  Settings many = once;
  for (int i = 0; i < 8; ++i) many = more_careful(many, sampling);
  EXPECT_EQ(many.registration.max_iterations, 50);
  EXPECT_NEAR(many.registration.convergence_rotation_rad, 1e-5 * kDegree, 1e-15);
  EXPECT_NEAR(many.registration.convergence_translation_m, 1e-4, 1e-15);
  EXPECT_NEAR(many.sampling.keypoint_voxel_size_m, 0.4, 1e-12) << "not finer with each";
}

TEST(CtIcpRobust, AScanIsTrustedThatNeitherTurnsNorMovesFar) {
  const RobustRegistration robust(enabled(6));
  const RegistrationConfig limits;
  const Pose start = Pose::Identity();
  EXPECT_TRUE(robust.trusts(turned(2.9, 0.9), start, limits));
  EXPECT_FALSE(robust.trusts(turned(3.1), start, limits));
  EXPECT_FALSE(robust.trusts(turned(0.0, 1.1), start, limits));
  EXPECT_FALSE(robust.trusts(turned(0.0), turned(-3.1).end, limits)) << "since the last one";
  EXPECT_FALSE(robust.trusts(turned(0.0, std::nan("")), start, limits));
}

TEST(CtIcpRobust, AfterTroubleTheNextScanBeginsWithMoreCare) {
  RobustRegistration robust(enabled(6));
  EXPECT_EQ(robust.first_level(), 0);
  EXPECT_TRUE(robust.admits(turned(1.0), Pose::Identity(), 1));
  EXPECT_EQ(robust.first_level(), 0);
  EXPECT_FALSE(robust.admits(turned(9.0), Pose::Identity(), 6)) << "it turns";
  EXPECT_EQ(robust.first_level(), 1);
  EXPECT_TRUE(robust.admits(turned(1.0), Pose::Identity(), 2));
  EXPECT_EQ(robust.first_level(), 1) << "it took two attempts";
  RobustConfig careful = enabled(6);
  careful.minimal_level = 2;
  EXPECT_EQ(RobustRegistration(careful).first_level(), 2);
}

/// Rests for 0.5 s, then yaws at the given rate.
std::vector<Scan> resting_then_yawing(double degrees_per_second, double seconds) {
  const auto motion = [=](double t) {
    const double angle = std::max(0.0, t - 0.5) * degrees_per_second * kDegree;
    return make_pose(so3::exp({0, 0, angle}), Eigen::Vector3d::Zero());
  };
  return synthetic::scans_of({.motion = motion, .seconds = seconds});
}

TEST(CtIcpRobust, ATurningScanTakesAllAttemptsAndStaysOutOfTheMapUnlessAllAreWanted) {
  for (const bool all : {false, true}) {
    Config config = indoor(room_lidar());
    config.robust = enabled(3);
    config.map.always_insert = all;
    CtIcp odometry(config, room_lidar(), Parallel(1));
    int index = 0;
    for (const Scan& scan : resting_then_yawing(60.0, 0.8)) {
      const ScanResult result = odometry.register_scan(scan);
      const bool turns = index >= 6;  // the sixth ends as it begins to turn: six degrees a scan
      if (index != 5) {
        EXPECT_EQ(result.detail("attempts").value(), turns ? 3 : 1) << index;
        EXPECT_EQ(result.detail("inserted").value() != 0, all || !turns) << index;
      }
      EXPECT_EQ(result.status, index == 0 ? ScanStatus::kInitializing : ScanStatus::kTracked);
      ++index;
    }
  }
}

TEST(CtIcpRobust, ItDoesNotEndAtALargeRotationButWithTooFewMatches) {
  Config config = indoor(room_lidar());
  config.robust = enabled(2);
  CtIcp odometry(config, room_lidar(), Parallel(1));
  std::vector<Scan> scans = resting_then_yawing(400.0, 1.0);
  scans[8].points.resize(10);
  int index = 0;
  for (const Scan& scan : scans) {
    const ScanStatus status = odometry.register_scan(scan).status;
    EXPECT_EQ(status == ScanStatus::kDiverged, index >= 8) << index;
    ++index;
  }
}

}  // namespace
}  // namespace lidarena::odometry::ct_icp
