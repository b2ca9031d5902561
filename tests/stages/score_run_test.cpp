// SPDX-License-Identifier: BSD-3-Clause
// Scores of runs whose sensors and worlds have errors, from the simulation on.
#include "lidarena/stages/score_run.hpp"

#include <gtest/gtest.h>

#include "lidarena/stages/run_algorithm.hpp"
#include "lidarena/stages/simulate_dataset.hpp"
#include "tests/study/configs.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::stages {
namespace {

using study::kConfigs;

constexpr std::size_t kScans = 50;  // in 5 s

class ScoreRun : public testing::Test {
 protected:
  ScoreRun() {
    request_.world = kConfigs / "worlds/house.yaml";
    request_.flight = kConfigs / "flights/house_aggressive.yaml";
    request_.sensors = {kConfigs / "sensors/livox_mid360.yaml"};
    request_.seconds = 5.0;
    request_.data = false;
  }
  /// Of a method over the flight with these settings of the sensor.
  results::RunMetrics scored(const std::vector<std::string>& set, const ScoreParts& parts,
                             const char* algorithm = "arena_lio") {
    request_.set = set;
    simulate_dataset(request_, folder_.path() / "data", Parallel(2), log_);
    RunRequest run;
    run.odometry.algorithm = algorithm;
    run.dataset = folder_.path() / "data";
    run.maps = scores_maps(parts);
    run_algorithm(run, folder_.path() / "run", Parallel(2), log_);
    return score_run(folder_.path() / "run", parts, Parallel(2), log_);
  }

  TemporaryFolder folder_;
  SimulateRequest request_;
  LogSink log_;
};

TEST_F(ScoreRun, AtTheLidarsClockAnOffsetIsNoError) {
  const ScoreParts trajectory{ScorePart::kTrajectory};
  const auto right = scored({}, trajectory).final->rpe;
  const auto late = scored({"sensor.noise.clock.offset_s=0.1"}, trajectory).final->rpe;
  EXPECT_FALSE(right->at_lidar_clock_1m);
  ASSERT_TRUE(late->at_lidar_clock_1m);
  ASSERT_GT(right->at_poses_1m.used, 3U);
  // the measurements are the same, all stamps later by 0.1 s
  EXPECT_NEAR(late->at_lidar_clock_1m->translation.rmse, right->at_poses_1m.translation.rmse, 1e-6);
  EXPECT_GT(late->at_poses_1m.translation.rmse, 2.0 * right->at_poses_1m.translation.rmse);
  const auto jitter = scored({"sensor.noise.clock.stamp_jitter_s=0.001"}, trajectory).final->rpe;
  EXPECT_FALSE(jitter->at_lidar_clock_1m) << "neither offset nor drift";
}

TEST_F(ScoreRun, DelayJitterAndLostSamplesRefuseNoScan) {
  const auto expect_none_refused = [&](const std::vector<std::string>& set, const char* algorithm) {
    const results::RunMetrics metrics = scored(set, {ScorePart::kTrajectory}, algorithm);
    ASSERT_EQ(metrics.status, "ok") << metrics.reason;
    EXPECT_EQ(metrics.scans.registered, kScans);
    EXPECT_EQ(metrics.scans.refused, 0U);
  };
  // ten times the jitter, fifty times the losses of the sensors *_harsh
  expect_none_refused({"sensor.noise.clock={drift: 1.0e-3, stamp_jitter_s: 0.002}",
                       "imu.delay_s=0.005", "imu.stamp_jitter_s=0.002", "imu.lost_share=0.05"},
                      "arena_lio");
  // stamps that err by almost half a period
  expect_none_refused({"sensor.noise.clock.stamp_jitter_s=0.1"}, "kiss_icp");
}

TEST_F(ScoreRun, AMapOfALivingWorldHasPointsOfMovers) {
  request_.world = folder_.write(
      "living.yaml",
      "kind: house\nseed: 1\npeople: 6\nmovers:\n  - {name: cart, kind: box, path: [[4, 4, 0], "
      "[8, 4, 0]], size: [1, 0.6, 1.2]}\n");
  request_.hits = true;
  const results::RunMetrics metrics = scored({}, {ScorePart::kMap});
  ASSERT_TRUE(metrics.maps.reprojected);
  const results::MapScores& map = metrics.maps.reprojected->se3;
  EXPECT_EQ(map.classes.points, map.points);
  EXPECT_EQ(map.classes.points, map.classes.world->points + map.classes.mover->points);
  EXPECT_GT(map.classes.mover->points, 100U);
  EXPECT_GT(*map.classes.mover->rmse_m, 2.0 * *map.classes.world->rmse_m)
      << "the mesh does not have them";
  EXPECT_TRUE(metrics.maps.own->se3.classes.refused);
  EXPECT_FALSE(metrics.maps.own->se3.classes.mover);
}

}  // namespace
}  // namespace lidarena::stages
