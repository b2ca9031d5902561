// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/lio_sam/lio_sam.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "lidarena/base/so3.hpp"
#include "tests/odometry/synthetic_room.hpp"

namespace lidarena::odometry::lio_sam {
namespace {

using synthetic::Recording;

/// Results of all scans, each of which `change` may alter first.
std::vector<ScanResult> results_of(const Recording& recording, const Config& config,
                                   const std::function<void(Scan&, std::size_t)>& change = {}) {
  const Rig rig = synthetic::rig_of(recording);
  LioSam odometry(config, rig.lidars[0], rig.imus[0], Parallel(1));
  std::vector<ScanResult> results;
  for (const Event& event : synthetic::record(recording)) {
    if (const auto* scan = std::get_if<Scan>(&event.data)) {
      Scan changed = *scan;
      if (change) change(changed, results.size());
      results.push_back(odometry.register_scan(changed));
    } else {
      odometry.register_imu(std::get<ImuSample>(event.data));
    }
  }
  return results;
}

Config spinning() { return indoor(synthetic::rig_of({}).lidars[0]); }

TEST(LioSamKeyframes, ComeWithDistanceTurnAndInThePortWithTime) {
  Config config;
  const map::Keyframe last{from_seconds(10.0), Pose::Identity(), {}, 0};
  const auto moved = [](double x, double yaw) {
    return make_pose(so3::exp({0, 0, yaw}), {x, 0, 0});
  };
  EXPECT_FALSE(is_keyframe(last, from_seconds(100.0), moved(0.99, 0.19), config));
  EXPECT_TRUE(is_keyframe(last, from_seconds(11.0), moved(1.0, 0.0), config));
  EXPECT_TRUE(is_keyframe(last, from_seconds(11.0), moved(0.0, -0.2), config));
  config.sensor = Sensor::kLivox;
  EXPECT_FALSE(is_keyframe(last, from_seconds(11.0), moved(0.0, 0.0), config));
  EXPECT_TRUE(is_keyframe(last, from_seconds(11.1), moved(0.0, 0.0), config));
}

TEST(LioSam, StandingStillOnlyThePortsMapGrows) {
  const Recording still{.motion = [](double) { return synthetic::flight(0.0); }};
  Config config = spinning();
  EXPECT_EQ(results_of(still, config).back().detail("keyframes"), 1.0);
  config.sensor = Sensor::kLivox;
  EXPECT_GE(results_of(still, config).back().detail("keyframes").value(), 3.0);
}

TEST(LioSam, UsesEverySecondScan) {
  const std::vector<ScanResult> results = results_of({}, spinning());
  for (std::size_t i = 2; i < results.size(); ++i)
    EXPECT_EQ(results[i].detail("iterations").has_value(), i % 2 == 0) << i;
}

TEST(LioSam, ThePositionOfAMovingSensorIsThatOfTheMiddleOfTheScan) {
  // 1 m/s along x, without rotation, so that only the translation within the scan remains
  const Recording moving{.motion = [](double seconds) {
    Pose pose = Pose::Identity();
    pose.translation() = Eigen::Vector3d(-2.0 + std::max(0.0, seconds - 1.0), 0.4, 1.5);
    return pose;
  }};
  const std::vector<ScanResult> results = results_of(moving, spinning());
  const StampedPose& start = results[8].estimate;  // at rest
  const StampedPose& last = results[30].estimate;
  const Pose moved = start.world_from_body.inverse() * last.world_from_body;
  const Pose truth = synthetic::truth(moving, start.stamp, last.stamp);
  EXPECT_NEAR(moved.translation().x() - truth.translation().x(), 0.05, 0.025)
      << "half of 0.1 s at 1 m/s";
}

TEST(LioSam, ScansWithoutEnoughEdgesAreNotRegisteredAndMakeTheImuOdometryFail) {
  Config config = spinning();
  config.min_edges = 1'000'000;
  const std::vector<ScanResult> results = results_of({.seconds = 8.0}, config);
  EXPECT_EQ(results[10].status, ScanStatus::kTooFewPoints);
  EXPECT_EQ(results[10].detail("iterations"), 0.0);
  EXPECT_EQ(results[10].counters.imu_restarts, 0U) << "at rest no motion is right";
  EXPECT_GT(results.back().detail("keyframes").value(), 1.0)
      << "the guesses become keyframes all the same";
}

TEST(LioSam, TheMotionWithinAScanBeginsAtItsPose) {
  for (const ScanResult& result : results_of({}, spinning())) {
    ASSERT_GE(result.motion.size(), 2U);
    EXPECT_EQ(result.motion.front().stamp, result.estimate.stamp);
    EXPECT_LT(
        (result.motion.front().world_from_body.matrix() - result.estimate.world_from_body.matrix())
            .norm(),
        1e-9);
  }
}

TEST(LioSam, WithoutPointTimesThereIsNoMotionWithinTheScan) {
  const auto untime = [](Scan& scan, std::size_t) {
    scan.timed = false;
    for (Point& point : scan.points) point.dt_ns = 0;
  };
  for (const ScanResult& result : results_of({}, spinning(), untime))
    EXPECT_TRUE(result.motion.empty());
}

TEST(LioSam, WithoutImuEveryScanSaysSo) {
  const Rig rig = synthetic::rig_of({});
  LioSam odometry(spinning(), rig.lidars[0], rig.imus[0], Parallel(1));
  for (const Scan& scan : synthetic::scans_of({.seconds = 0.3}))
    EXPECT_EQ(odometry.register_scan(scan).status, ScanStatus::kInitializing);
  EXPECT_TRUE(odometry.map().empty());
}

}  // namespace
}  // namespace lidarena::odometry::lio_sam
