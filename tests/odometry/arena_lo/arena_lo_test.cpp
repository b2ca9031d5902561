// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lo/arena_lo.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lidarena/base/so3.hpp"
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
    EXPECT_EQ(result.detail("inserted").value(), i != 8) << i;
  }
}

TEST(ArenaLo, FollowsTurnsOfFortyDegreesAScan) {
  const auto turning = [](double t) {
    const double phase = 8.0 * std::max(0.0, t - 1.0);  // from rest
    return synthetic::flight(0.0) *
           make_pose(so3::exp({0, 0, 0.9 * (1.0 - std::cos(phase))}), Eigen::Vector3d::Zero());
  };
  const synthetic::Recording recording{.motion = turning, .seconds = 3.0, .range_noise_m = 0.02};
  ArenaLo odometry(settings_for(lidar()), lidar(), Parallel(1));
  ScanResult result;
  for (const Scan& scan : synthetic::scans_of(recording)) {
    result = odometry.register_scan(scan);
    EXPECT_NE(result.status, ScanStatus::kTooFewPoints);
    const Pose truth = synthetic::truth(recording, recording.epoch, result.estimate.stamp);
    const Pose error = truth.inverse() * result.estimate.world_from_body;
    EXPECT_LT(so3::angle(error.linear()), 0.02);
    EXPECT_LT(error.translation().norm(), 0.02);
  }
  EXPECT_EQ(result.status, ScanStatus::kTracked);
}

TEST(ArenaLo, AStartInFlightIsKnownFromItsFirstPoseOn) {
  const auto turning = [](double t) {  // at 3 m/s and up to 50 degrees/s
    const Eigen::Vector3d position(3.0 * std::sin(t), 2.0 - 2.0 * std::cos(t),
                                   0.3 * std::sin(2.0 * t));
    return make_pose(so3::exp({0.0, 0.0, 0.6 * std::sin(1.5 * t)}), position);
  };
  const synthetic::Recording flying{
      .motion = turning, .seconds = 1.5, .points_per_scan = 20480, .repeating = false};
  ArenaLo odometry(settings_for(lidar()), lidar(), Parallel(1));
  for (const Scan& scan : synthetic::scans_of(flying)) odometry.register_scan(scan);
  const Trajectory estimate = odometry.trajectory();
  const StampedPose first = estimate.poses().front();
  for (const StampedPose& pose : estimate.poses()) {
    const Pose moved = first.world_from_body.inverse() * pose.world_from_body;
    const Pose error = moved.inverse() * synthetic::truth(flying, first.stamp, pose.stamp);
    EXPECT_LT(error.translation().norm(), 0.02) << to_seconds(pose.stamp - first.stamp) << " s";
    EXPECT_LT(so3::angle(error.linear()), 0.01);
  }
}

TEST(ArenaLo, TheMotionWithinAScanBeginsAfterTheLastOneAndEndsAtThePose) {
  ArenaLo odometry(settings_for(lidar()), lidar(), Parallel(1));
  Time last{0};
  for (const Scan& scan : synthetic::scans_of({.seconds = 1.0})) {
    const ScanResult result = odometry.register_scan(scan);
    ASSERT_GT(result.motion.size(), 2U);
    EXPECT_GT(result.motion.front().stamp, last);
    EXPECT_EQ(result.motion.back().stamp, result.estimate.stamp);
    EXPECT_EQ(result.motion.back().world_from_body.matrix(),
              result.estimate.world_from_body.matrix());
    last = result.estimate.stamp;
  }
}

TEST(ArenaLo, EachScanRevisesTheMotionOfTheOneBefore) {
  ArenaLo odometry(settings_for(lidar()), lidar(), Parallel(1));
  ScanResult before;
  std::size_t scans = 0;
  for (const Scan& scan : synthetic::scans_of({.seconds = 1.0})) {
    const ScanResult result = odometry.register_scan(scan);
    if (scans++ < 2) {
      EXPECT_TRUE(result.revised.empty()) << "of the opening";
    } else {
      ASSERT_EQ(result.revised.size(), before.motion.size());
      for (std::size_t i = 0; i < before.motion.size(); ++i)
        EXPECT_EQ(result.revised[i].stamp, before.motion[i].stamp);
      const Trajectory trajectory = odometry.trajectory();
      const StampedPose& now = *(trajectory.poses().end() - 2);
      EXPECT_EQ(now.stamp, before.estimate.stamp);
      EXPECT_EQ(now.world_from_body.matrix(), result.revised.back().world_from_body.matrix());
    }
    before = result;
  }
}

TEST(ArenaLo, APoseIsMoreAccurateOnceTheNextScanIsThere) {
  const synthetic::Recording recording{.seconds = 4.0, .range_noise_m = 0.03, .repeating = false};
  ArenaLo odometry(settings_for(lidar()), lidar(), Parallel(1));
  double live = 0.0;
  double revised = 0.0;
  const auto squared_error = [&](const StampedPose& pose) {
    const Pose truth = synthetic::truth(recording, recording.epoch, pose.stamp);
    return (truth.translation() - pose.world_from_body.translation()).squaredNorm();
  };
  const std::vector<Scan> scans = synthetic::scans_of(recording);
  StampedPose before;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const ScanResult result = odometry.register_scan(scans[i]);
    if (i > 4) {
      live += squared_error(before);
      revised += squared_error(result.revised.back());
    }
    before = result.estimate;
  }
  EXPECT_LT(std::sqrt(revised), 0.8 * std::sqrt(live));
}

}  // namespace
}  // namespace lidarena::odometry::arena_lo
