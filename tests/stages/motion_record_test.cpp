// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/stages/motion_record.hpp"

#include <gtest/gtest.h>

#include <chrono>

#include "lidarena/base/so3.hpp"

namespace lidarena::stages {
namespace {

using namespace std::chrono_literals;
using Eigen::Vector3d;

/// A body that flies a screw at 10 m/s and turns.
Pose screw(Time t) {
  const double s = to_seconds(t);
  return make_pose(so3::exp({0.3 * s, -0.2, 2.0 * s}), Vector3d(10.0 * s, std::sin(3.0 * s), 0.2));
}

/// A scan of 100 ms whose pose holds at its end, with the motion every `step`.
odometry::ScanResult scan_ending(Time end, Time step,
                                 const Pose& live_from_world = Pose::Identity()) {
  odometry::ScanResult result;
  result.estimate = {end, live_from_world * screw(end)};
  for (Time t = end - 100ms; t < end; t += step)
    result.motion.push_back({t, live_from_world * screw(t)});
  result.motion.push_back({end, result.estimate.world_from_body});
  return result;
}

/// The true poses at the scans' ends.
Trajectory ends(int scans) {
  std::vector<StampedPose> poses;
  for (int i = 1; i <= scans; ++i) poses.push_back({i * 100ms, screw(i * 100ms)});
  return Trajectory(std::move(poses));
}

TEST(MotionRecord, IsTheMotionWithinTheScansWithPosesFiveMillisecondsApart) {
  MotionRecord record;
  for (int i = 1; i <= 5; ++i) record.add(scan_ending(i * 100ms, 1ms));
  const Trajectory motion = record.along(ends(5));
  EXPECT_EQ(motion.begin_time(), Time{0});
  EXPECT_EQ(motion.size(), 5U * 20U + 1U);
  for (const StampedPose& pose : motion.poses())
    EXPECT_TRUE(pose.world_from_body.isApprox(screw(pose.stamp), 1e-6));
}

TEST(MotionRecord, FollowsTheTrajectoryAsItIsAtTheEnd) {
  MotionRecord record;
  const Pose corrected = make_pose(so3::exp({0.0, 0.1, 0.7}), Vector3d(3, -2, 1));
  for (int i = 1; i <= 3; ++i) record.add(scan_ending(i * 100ms, 10ms, corrected));
  const Trajectory motion = record.along(ends(3));
  ASSERT_EQ(motion.size(), 31U);
  for (const StampedPose& pose : motion.poses())
    EXPECT_TRUE(pose.world_from_body.isApprox(screw(pose.stamp), 1e-6));
}

TEST(MotionRecord, AScanWithoutMotionIsAtItsEstimate) {
  MotionRecord record;
  odometry::ScanResult first;
  first.estimate = {100ms, screw(100ms)};
  record.add(first);
  record.add(scan_ending(200ms, 50ms));
  record.add(scan_ending(900ms, 50ms));  // outside the trajectory: left out
  const Trajectory motion = record.along(ends(2));
  ASSERT_EQ(motion.size(), 3U);  // the second scan begins where the first one's pose is
  EXPECT_EQ(motion.poses()[0].stamp, Time{100ms});
  EXPECT_EQ(motion.poses()[1].stamp, Time{150ms});
}

TEST(MotionRecord, WhatAScanRevisesReplacesTheMotionOfTheOneBefore) {
  const Pose off = make_pose(so3::exp({0.0, 0.0, 0.01}), Vector3d(0.01, 0, 0));
  MotionRecord record;
  for (int i = 1; i <= 3; ++i) {
    odometry::ScanResult result = scan_ending(i * 100ms, 10ms);
    for (StampedPose& pose : result.motion)
      if (pose.stamp != result.estimate.stamp) pose.world_from_body = pose.world_from_body * off;
    if (i > 1) result.revised = scan_ending((i - 1) * 100ms, 10ms).motion;
    record.add(result);
  }
  const Trajectory motion = record.along(ends(3));
  ASSERT_EQ(motion.size(), 31U);
  for (const StampedPose& pose : motion.poses()) {
    const bool is_revised = pose.stamp <= 200ms || pose.stamp == 300ms;
    EXPECT_EQ(pose.world_from_body.isApprox(screw(pose.stamp), 1e-6), is_revised)
        << to_seconds(pose.stamp);
  }
}

TEST(MotionRecord, IsEmptyIfNoScanTellsAMotion) {
  MotionRecord record;
  for (int i = 1; i <= 3; ++i) {
    odometry::ScanResult result;
    result.estimate = {i * 100ms, screw(i * 100ms)};
    record.add(result);
  }
  EXPECT_TRUE(record.along(ends(3)).empty());
}

}  // namespace
}  // namespace lidarena::stages
