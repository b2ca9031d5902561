// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/evaluate_run.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flights.hpp"
#include "lidarena/base/config_json.hpp"
#include "lidarena/evaluation/trajectory/trajectory_metrics.hpp"
#include "meshes.hpp"

namespace lidarena::evaluation {
namespace {

using namespace std::chrono_literals;
using Eigen::Vector3d;
using flights::level;
using flights::mapped;
using flights::sample;
using flights::tour;
using ::testing::HasSubstr;

/// A run whose world frame differs from the truth's by `truth_from_estimate` and whose live
/// trajectory drifts, in a room of 16 x 12 x 8 m whose walls its map has without error.
dataset::RunFiles perfect_run(const Pose& truth_from_estimate) {
  const Pose back = truth_from_estimate.inverse();
  dataset::RunFiles run;
  const Trajectory truth = sample(tour, 100ms, 30s);
  run.trajectory =
      mapped(truth, [&](const StampedPose& pose) { return back * pose.world_from_body; });
  run.live = mapped(run.trajectory, [](const StampedPose& pose) {
    return level({0.01 * to_seconds(pose.stamp), 0, 0}) * pose.world_from_body;
  });
  SequentialRandom random(41);
  for (int i = 0; i < 5000; ++i) {
    const Vector3d wall(8.0, random.uniform(-6, 6), random.uniform(-4, 4));
    run.map.points.push_back((back * wall).cast<float>());
  }
  run.reprojected = run.map;
  return run;
}

class EvaluateRun : public ::testing::Test {
 protected:
  EvaluateRun() : world_(meshes::box(Vector3d(8, 6, 4))) {
    SequentialRandom random(40);
    truth_from_estimate_ = flights::random_pose(random, 2.0);
    run_ = perfect_run(truth_from_estimate_);
  }
  /// As in the files.
  Json evaluate() { return to_json(evaluate_run(run_, truth_, &world_, Parallel(1), log_)); }

  world::World world_;
  LogSink log_;
  Pose truth_from_estimate_;
  dataset::RunFiles run_;
  Trajectory truth_ = sample(tour, 5ms, 30s);
};

TEST_F(EvaluateRun, APerfectRunWithAWrongClockIsPerfectAtThatClock) {
  const auto clock = [](Time t) { return 20ms + t + Time{t.count() / 1000}; };  // 1 ms per second
  const auto stamped = [&](const Trajectory& trajectory) {
    std::vector<StampedPose> poses(trajectory.poses().begin(), trajectory.poses().end());
    for (StampedPose& pose : poses) pose.stamp = clock(pose.stamp);
    return Trajectory(std::move(poses));
  };
  const Json right = evaluate()["final"]["rpe"];
  EXPECT_TRUE(right["1m_at_lidar_clock"].is_null());
  EXPECT_LT(right["1m_at_poses"]["translation"]["rmse_m"], 1e-9);
  run_.trajectory = stamped(run_.trajectory);
  const Trajectory at_clock = stamped(truth_);
  const Json wrong = to_json(evaluate_run(run_, truth_, &world_, Parallel(1), log_, {}, &at_clock));
  const Json& rpe = wrong["final"]["rpe"];
  EXPECT_GT(rpe["1m_at_poses"]["translation"]["rmse_m"], 1e-3);
  EXPECT_LT(rpe["1m_at_lidar_clock"]["translation"]["rmse_m"], 1e-9);
  EXPECT_EQ(rpe["1m_at_lidar_clock"]["used"], right["1m_at_poses"]["used"]);
  EXPECT_LT(rpe["1m_at_lidar_clock"]["translation"]["rmse_m"],
            rpe["1m_at_best_offset"]["rpe"]["translation"]["rmse_m"])
      << "an offset alone does not take the drift away";
}

TEST_F(EvaluateRun, RefusedAndDroppedScansAreCountedAndSaid) {
  EXPECT_TRUE(evaluate()["scans"].is_null()) << "the manifest counts none";
  run_.manifest.summary.scans = 298;
  EXPECT_THAT(evaluate()["warnings"], testing::Not(testing::Contains(HasSubstr("refused"))));
  run_.manifest.summary.refused = 2;
  run_.manifest.summary.dropped = 5;
  const Json metrics = evaluate();
  EXPECT_EQ(metrics["scans"], Json({{"registered", 298}, {"refused", 2}, {"dropped", 5}}));
  EXPECT_THAT(metrics["warnings"], testing::Contains(HasSubstr("2 of 300 scans were refused")));
}

TEST_F(EvaluateRun, TheOwnMapHasNoClassesAndSaysWhy) {
  run_.manifest.own_map = dataset::OwnMap::kMeans;
  EXPECT_THAT(evaluate()["maps"]["own"]["se3"]["classes"]["refused"].get<std::string>(),
              HasSubstr("means of returns"));
  run_.manifest.own_map = dataset::OwnMap::kReturns;
  const Json maps = evaluate()["maps"];
  EXPECT_THAT(maps["own"]["se3"]["classes"]["refused"].get<std::string>(),
              HasSubstr("does not say of which returns"));
  EXPECT_TRUE(maps["reprojected"]["se3"]["classes"].is_null());
}

TEST_F(EvaluateRun, APerfectRunScoresNextToNothingInEveryAlignment) {
  const Json m = evaluate();
  EXPECT_EQ(m["schema"], "lidarena.metrics");
  EXPECT_EQ(m["schema_version"], results::kMetricsSchemaVersion);
  EXPECT_EQ(m["status"], "ok");
  EXPECT_TRUE(m["warnings"].empty()) << m["warnings"];
  EXPECT_EQ(m["final"]["association"]["matched"], 301);
  EXPECT_EQ(m["final"]["rpe"]["1m"]["used"], m["final"]["rpe"]["1m"]["total"]);
  // error of linear interpolation at 10 Hz: a T^2 / 8 = 1.6 mm at each end
  EXPECT_LT(m["final"]["rpe"]["1m"]["translation"]["rmse_m"], 0.0033);
  EXPECT_LT(m["final"]["rpe"]["1m_at_poses"]["translation"]["rmse_m"], 1e-9);
  const Json& rpe = m["final"]["rpe"]["1m"];
  EXPECT_NEAR(rpe["floor"]["translation_rmse_m"], rpe["translation"]["rmse_m"], 1e-12);
  EXPECT_NEAR(rpe["floor"]["rotation_rmse_rad"], rpe["rotation"]["rmse_rad"], 1e-12);
  for (const char* alignment : {"first_pose", "se3"}) {
    EXPECT_LT(m["final"]["ate"][alignment]["translation"]["rmse_m"], 1e-9);
    for (const char* map : {"own", "reprojected"}) {
      EXPECT_LT(m["maps"][map][alignment]["distance"]["rmse_m"], 1e-5);
      EXPECT_EQ(m["maps"][map][alignment]["points"], 5000);
      EXPECT_EQ(m["maps"][map][alignment]["histogram"]["counts"][0], 5000);
    }
  }
}

TEST_F(EvaluateRun, LiveAndFinalTrajectoriesAreScoredEach) {
  const Json m = evaluate();
  // the live one drifts 30 cm in 30 s
  EXPECT_NEAR(m["live"]["ate"]["first_pose"]["translation"]["max_m"], 0.30, 1e-9);
  EXPECT_LT(m["final"]["ate"]["first_pose"]["translation"]["max_m"], 1e-9);
}

TEST_F(EvaluateRun, EveryMetricNamesItsDefinition) {
  const Json m = evaluate();
  EXPECT_EQ(m["final"]["rpe"]["1m"]["definition"], "rpe_1m[ref-arc,1m,disjoint,interp,gap1.5]");
  EXPECT_EQ(m["final"]["rpe"]["1m_at_poses"]["definition"],
            "rpe_1m_at_poses[ref-arc,1m,disjoint,nearest-poses,gap1.5]");
  EXPECT_EQ(m["final"]["rpe"]["1s"]["definition"], "rpe_1s[time,1s,disjoint,interp,gap1.5]");
  EXPECT_EQ(m["final"]["ate"]["se3"]["definition"], "ate_se3[est-stamps,ref-interp,gap1.5]");
  EXPECT_EQ(m["final"]["kitti"]["definition"],
            "kitti[est-poses,ref-arc,every10,first-beyond,100-800m]");
  EXPECT_EQ(m["final"]["kitti_short"]["definition"],
            "kitti[est-poses,ref-arc,every10,first-beyond,1-50m]");
  EXPECT_EQ(m["maps"]["own"]["se3"]["definition"], "map_error[point-triangle,all-points,20cm]");
  EXPECT_EQ(definition_id(relative_pose_error(truth_, truth_, 1.0, 0.1)),
            "rpe_1m[ref-arc,1m,every0.1m,interp,gap1.5]");
}

TEST_F(EvaluateRun, AHoverIsScoredByItsJitterAndByTheSecondWhereThereAreNoMeters) {
  const auto still = [](double) { return level({1, 2, 0}); };
  truth_ = sample(still, 5ms, 30s);
  run_.trajectory = run_.live = sample(still, 100ms, 30s);
  const Json m = evaluate();
  EXPECT_TRUE(m["final"]["rpe"]["1m"]["translation"].is_null());
  EXPECT_EQ(m["final"]["rpe"]["1s"]["used"], 30);
  EXPECT_NEAR(m["final"]["hover_jitter"]["hovered_s"], 30.0, 1e-9);
}

TEST_F(EvaluateRun, RungsLongerThanTheFlightAreNullNotZero) {
  ASSERT_LT(truth_.path_length(), 60.0);
  truth_ = sample(tour, 5ms, 5s);
  run_.trajectory = run_.live = sample(tour, 100ms, 5s);
  const Json m = evaluate();
  EXPECT_EQ(m["final"]["rpe"]["50m"]["total"], 0);
  EXPECT_TRUE(m["final"]["rpe"]["50m"]["translation"].is_null());
}

TEST_F(EvaluateRun, AnotherBodyFrameIsWarnedOfAndItsArmShown) {
  const Pose arm = make_pose(so3::exp({0, 0, 0.3}), Vector3d(0.25, -0.10, 0.15));
  run_.trajectory = run_.live = mapped(sample(tour, 100ms, 30s), [&](const StampedPose& pose) {
    return pose.world_from_body * arm;
  });
  const Json m = evaluate();
  ASSERT_EQ(m["warnings"].size(), 1U) << m["warnings"];
  EXPECT_THAT(m["warnings"][0].get<std::string>(), HasSubstr("another frame of the body"));
  const Json& seen = m["final"]["association"]["lever_arm"];
  EXPECT_NEAR(seen["position_m"][0], 0.25, 0.01);
  EXPECT_NEAR(seen["rotation_vector_rad"][2], 0.3, 0.01);
}

TEST_F(EvaluateRun, PosesTooSeldomForTheMotionAreWarnedOf) {
  // Two poses a second: a T^2 / 8 = 4 cm in a curve of 1.3 m/s^2.
  std::vector<StampedPose> seldom;
  for (std::size_t i = 0; i < run_.trajectory.size(); i += 5) {
    seldom.push_back(run_.trajectory.poses()[i]);
  }
  run_.trajectory = Trajectory(seldom);
  const Json m = evaluate();
  const Json& rpe = m["final"]["rpe"]["1m"];
  EXPECT_NEAR(rpe["floor"]["translation_rmse_m"], rpe["translation"]["rmse_m"], 1e-12);
  EXPECT_GT(rpe["floor"]["translation_rmse_m"], 0.005);
  EXPECT_THAT(m["warnings"].dump(), HasSubstr("give poses more often"));
}

TEST_F(EvaluateRun, ATruthThatIsCoarserThanTheEstimateIsNoErrorOfIt) {
  for (const Time period : {125ms, 200ms, 500ms, 1000ms}) {
    truth_ = sample(tour, period, 30s);
    run_.trajectory = sample(tour, 25ms, 30s);  // has a pose at each stamp of the truth
    const Json m = evaluate();
    EXPECT_LT(m["final"]["rpe"]["1m_at_poses"]["translation"]["rmse_m"], 1e-9);
    EXPECT_LT(m["final"]["rpe"]["1m"]["translation"]["rmse_m"], 1e-9);
    EXPECT_LT(m["final"]["ate"]["se3"]["translation"]["rmse_m"], 1e-9);
    EXPECT_THAT(m["warnings"].dump(), HasSubstr("compared at the truth's stamps only"));
  }
}

TEST_F(EvaluateRun, ASinglePoseAndForeignClocksAreNoNumbersButReasons) {
  const Trajectory whole = run_.trajectory;
  run_.trajectory = sample(tour, 100ms, 50ms);
  Json m = evaluate();
  EXPECT_EQ(m["status"], "no_output");
  EXPECT_EQ(m["reason"], "the estimate has a single pose");
  run_.trajectory = flights::shifted(whole, std::chrono::hours(1));
  m = evaluate();
  EXPECT_EQ(m["status"], "no_overlap");
  EXPECT_THAT(m["reason"].get<std::string>(), HasSubstr("clocks count from different instants"));
}

TEST_F(EvaluateRun, WhatARunCostIsThereEvenWhenItDiverged) {
  EXPECT_TRUE(evaluate()["resources"].is_null());  // no resources.csv
  run_.resources = {{0.1, 0.02, 0.02, 100, 90, 50, 5, 0}, {0.2, 0.03, 0.03, 120, 100, 60, 5, 0}};
  run_.manifest.status = dataset::RunStatus::kDiverged;
  run_.manifest.reason = "a pose was not finite";
  const Json m = evaluate();
  EXPECT_EQ(m["status"], "diverged");
  EXPECT_EQ(m["resources"]["scans"], 2);
  EXPECT_EQ(m["resources"]["own"]["peak_bytes"], 65.0);
  EXPECT_NEAR(m["resources"]["real_time_factor"], 4.0, 1e-12);
}

TEST_F(EvaluateRun, KittisErrorIsRefusedOnAShortFlightAndItsShortLadderIsThere) {
  const Json m = evaluate();
  EXPECT_THAT(m["final"]["kitti"]["refused"].get<std::string>(), HasSubstr("no piece of 100 m"));
  EXPECT_TRUE(m["final"]["kitti"]["translation_percent"].is_null());
  EXPECT_LT(m["final"]["kitti_short"]["translation_percent"], 1e-9);
  EXPECT_GT(m["final"]["kitti_short"]["pieces"], 100);
  EXPECT_EQ(m["final"]["kitti_short"]["lengths"].size(), 6U);
}

TEST_F(EvaluateRun, ADivergedRunHasAReasonAndNoNumber) {
  run_.trajectory = mapped(run_.trajectory, [](const StampedPose& pose) {
    const double t = to_seconds(pose.stamp);
    return level({0, 0, t > 20.0 ? 1e6 * (t - 20.0) : 0.0}) * pose.world_from_body;
  });
  const Json m = evaluate();
  EXPECT_EQ(m["status"], "diverged");
  EXPECT_THAT(m["reason"].get<std::string>(), HasSubstr("m from the truth 20.1 s into"));
  EXPECT_TRUE(m["final"].is_null());
  EXPECT_TRUE(m["maps"]["own"].is_null());
}

TEST_F(EvaluateRun, OfARunThatEndedItselfTheTrajectoryUntilThenIsScored) {
  EXPECT_TRUE(evaluate()["ended_at_s"].is_null());
  run_.manifest.status = dataset::RunStatus::kDiverged;
  run_.manifest.reason = "pose 100 is not finite";
  const auto first = [](const Trajectory& all, std::size_t n) {
    return Trajectory({all.poses().begin(), all.poses().begin() + static_cast<std::ptrdiff_t>(n)},
                      "cut");
  };
  run_.trajectory = first(run_.trajectory, 100);
  run_.live = first(run_.live, 100);
  const Json m = evaluate();
  EXPECT_EQ(m["status"], "diverged");
  EXPECT_EQ(m["reason"], "pose 100 is not finite");
  EXPECT_NEAR(m["ended_at_s"], 9.9, 1e-9) << "100 poses, one each 0.1 s";
  EXPECT_LT(m["final"]["rpe"]["1m_at_poses"]["translation"]["rmse_m"], 1e-9);
  EXPECT_GT(m["live"]["rpe"]["1m_at_poses"]["translation"]["rmse_m"], 1e-4);
  EXPECT_NEAR(m["final"]["association"]["coverage"], 9.9 / 30.0, 0.01);
  EXPECT_TRUE(m["maps"]["own"].is_null());
  run_.trajectory = run_.live = Trajectory();
  EXPECT_TRUE(evaluate()["final"].is_null());
}

TEST_F(EvaluateRun, NoPosesAndNoCommonTimeAreSaid) {
  const dataset::RunFiles whole = run_;
  run_.trajectory = Trajectory();
  EXPECT_EQ(evaluate()["status"], "no_output");
  run_.trajectory = flights::shifted(whole.trajectory, 100s);
  EXPECT_EQ(evaluate()["status"], "no_overlap");
}

TEST_F(EvaluateRun, WithoutMeshOrMapTheMapErrorIsNull) {
  run_.map = {};
  const Json m = evaluate();
  EXPECT_TRUE(m["maps"]["own"].is_null());
  EXPECT_FALSE(m["maps"]["reprojected"].is_null());
  const Json no_mesh = to_json(evaluate_run(run_, truth_, nullptr, Parallel(1), log_));
  EXPECT_TRUE(no_mesh["maps"]["reprojected"].is_null());
  EXPECT_FALSE(no_mesh["final"].is_null());
}

TEST_F(EvaluateRun, AStraightFlightHasNoSe3NumbersButAReason) {
  const auto line = [](double t) { return level({0.1 * t, 0, 0}); };
  truth_ = sample(line, 5ms, 30s);
  run_.trajectory = run_.live = sample(line, 100ms, 30s);
  const Json m = evaluate();
  EXPECT_THAT(m["final"]["ate"]["se3"]["refused"].get<std::string>(), HasSubstr("line"));
  EXPECT_TRUE(m["final"]["ate"]["se3"]["translation"].is_null());
  EXPECT_TRUE(m["maps"]["own"]["se3"]["refused"].is_string());
  EXPECT_TRUE(m["maps"]["own"]["se3"]["outliers_percent"].is_null());
  EXPECT_LT(m["final"]["ate"]["first_pose"]["translation"]["max_m"], 1e-9);
}

TEST_F(EvaluateRun, LateStampsAndMissingPartsAreWarnedOfButNotCorrected) {
  run_.trajectory = flights::with_gap(flights::shifted(run_.trajectory, 60ms), 10s, 20s);
  const Json m = evaluate();
  ASSERT_EQ(m["warnings"].size(), 2U);
  EXPECT_THAT(m["warnings"][0].get<std::string>(), HasSubstr("covers 66 %"));
  EXPECT_THAT(m["warnings"][1].get<std::string>(), HasSubstr("60 ms late"));
  EXPECT_GT(m["final"]["ate"]["se3"]["translation"]["rmse_m"], 0.01);
}

TEST(ErrorsOverTime, KeepsThePeakOfEveryRunOfNeighbors) {
  std::vector<PoseError> errors;
  for (int i = 0; i < 1000; ++i) errors.push_back({std::chrono::milliseconds(100 * i), 0.01, 0.0});
  errors[437].translation_m = 0.5;
  const results::ErrorsOverTime curve = errors_over_time(errors, Time(0), 100);
  EXPECT_EQ(curve.t_s.size(), 100U);
  EXPECT_EQ(curve.largest_of, 10U);
  EXPECT_EQ(curve.translation_m[43], 0.5);
  EXPECT_EQ(curve.t_s[43], 43.7);
}

}  // namespace
}  // namespace lidarena::evaluation
