// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/imu_track.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "lidarena/base/so3.hpp"
#include "lidarena/base/time.hpp"

namespace lidarena::estimation {
namespace {

const Eigen::Vector3d kRate(0.3, -0.5, 1.2);
const Eigen::Vector3d kVelocity(1.0, -2.0, 0.5);
const Eigen::Vector3d kAcceleration(3.0, 1.0, -2.0);

/// Constant rate and acceleration, in closed form.
Pose motion(double t) {
  return make_pose(so3::exp(kRate * t), kVelocity * t + 0.5 * t * t * kAcceleration);
}

ImuTrack track(int steps) {
  ImuTrack all;
  for (int i = 0; i < steps; ++i) {
    const double t = 0.1 * i / steps;
    all.push_back(
        {from_seconds(t), motion(t), kVelocity + t * kAcceleration, kAcceleration, kRate});
  }
  return all;
}

TEST(ImuTrack, GivesThePoseOfTheStepThatAnInstantFallsInto) {
  for (const double t : {-0.01, 0.0, 0.013, 0.05, 0.0999, 0.12}) {
    const Pose error = pose_at(track(20), from_seconds(t)).inverse() * motion(t);
    EXPECT_LT(error.translation().norm(), 1e-8) << t;  // a nanosecond at 2 m/s
    EXPECT_LT(so3::angle(error.linear()), 1e-8) << t;
  }
}

TEST(ImuTrack, TheMotionOfABodyIsThatOfTheTrackMovedToTheKnownPose) {
  const Pose imu_from_body = make_pose(so3::exp({0.1, 0.2, -0.3}), {0.05, -0.02, 0.1});
  const Pose elsewhere = make_pose(so3::exp({0.0, 0.3, 2.0}), {10.0, -4.0, 2.0});
  const auto poses = motion_along(track(20), from_seconds(0.012), from_seconds(0.1),
                                  from_seconds(0.1), elsewhere * motion(0.1), imu_from_body);
  ASSERT_EQ(poses.size(), 19U) << "both ends and the steps from 0.015 to 0.095 s";
  EXPECT_EQ(poses.front().stamp, from_seconds(0.012));
  EXPECT_EQ(poses.back().stamp, from_seconds(0.1));
  for (const StampedPose& pose : poses) {
    const Pose expected = elsewhere * motion(to_seconds(pose.stamp)) * imu_from_body;
    EXPECT_LT((pose.world_from_body.translation() - expected.translation()).norm(), 1e-7);
  }
  EXPECT_TRUE(motion_along({}, Time{0}, Time{5}, Time{5}, elsewhere, imu_from_body).empty());
  EXPECT_TRUE(motion_along(track(20), Time{5}, Time{5}, Time{5}, elsewhere, imu_from_body).empty());
}

TEST(ImuTrack, ABentTrackBeginsWhereItBeganAndEndsAtTheEstimate) {
  const Eigen::Vector3d shift(0.02, -0.03, 0.01);
  const Eigen::Vector3d turn(0.004, 0.01, -0.006);
  const Pose predicted = motion(0.1);
  const Pose estimate =
      make_pose(so3::exp(turn) * predicted.linear(), predicted.translation() + shift);
  const ImuTrack bent = bent_track(track(20), from_seconds(0.1), estimate);
  const auto expect_near = [](const Pose& a, const Pose& b) {
    EXPECT_LT((a.translation() - b.translation()).norm(), 1e-7);
    // within a step of 5 ms the two rotations do not commute: 1.3 * 0.12 / 2 * 0.005^2 rad
    EXPECT_LT(so3::angle(a.linear().transpose() * b.linear()), 3e-6);
  };
  expect_near(pose_at(bent, Time{0}), motion(0.0));
  expect_near(pose_at(bent, from_seconds(0.1)), estimate);
  // Halfway half of it, both at a step's begin and within a step; rates and velocities follow.
  for (const double t : {0.05, 0.0525}) {
    const double share = t / 0.1;
    expect_near(pose_at(bent, from_seconds(t)),
                make_pose(so3::exp(share * turn) * motion(t).linear(),
                          motion(t).translation() + share * shift));
  }
}

TEST(ImuTrack, NothingIsBentInNoTime) {
  const Pose elsewhere = motion(3.0);
  EXPECT_TRUE(bent_track({}, Time{5}, elsewhere).empty());
  const ImuTrack same = bent_track(track(3), Time{0}, elsewhere);
  EXPECT_EQ(pose_at(same, Time{0}).matrix(), pose_at(track(3), Time{0}).matrix());
}

TEST(ImuTrack, DeskewedPointsAreSeenFromTheEnd) {
  const Pose imu_from_lidar = make_pose(so3::exp({0.1, 0.2, -0.3}), {0.05, -0.02, 0.1});
  const Eigen::Vector3d landmark(4.0, 3.0, -1.0);
  Scan scan;
  scan.stamp = Time{0};
  for (int i = 0; i <= 100; ++i) {
    Point point;
    point.dt_ns = 1'000'000 * i;
    const Pose lidar = motion(1e-3 * i) * imu_from_lidar;
    point.position = (lidar.inverse() * landmark).cast<float>();
    scan.points.push_back(point);
  }
  const Eigen::Vector3f from_end =
      ((motion(0.1) * imu_from_lidar).inverse() * landmark).cast<float>();
  for (const Eigen::Vector3f& point :
       deskew(scan, track(20), imu_from_lidar, motion(0.1), Parallel(2))) {
    EXPECT_LT((point - from_end).norm(), 5e-6F) << "a few units in the last place of 5 m";
  }
}

TEST(ImuTrack, UntimedScansStayAndBadPointsStayBad) {
  Scan scan;
  scan.points = {Point{}, Point{}};
  scan.points[0].position = {1.0F, 2.0F, 3.0F};
  scan.points[1].position.x() = std::numeric_limits<float>::quiet_NaN();
  scan.points[1].dt_ns = 5;
  const Pose none = Pose::Identity();
  EXPECT_FALSE(deskew(scan, track(5), none, motion(0.1), Parallel(1))[1].allFinite());
  scan.timed = false;
  EXPECT_EQ(deskew(scan, track(5), none, motion(0.1), Parallel(1))[0], scan.points[0].position);
}

}  // namespace
}  // namespace lidarena::estimation
