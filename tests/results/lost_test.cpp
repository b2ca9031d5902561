// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/lost.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "lidarena/base/angle.hpp"
#include "lidarena/results/study_cells.hpp"
#include "made_up_runs.hpp"

namespace lidarena::results {
namespace {

using made_up::run_of;
using ::testing::HasSubstr;

TEST(Lost, IsWhatHasNoResultOrDriftsByMoreThanItMovesOrTwentyDegreesPerMeter) {
  EXPECT_FALSE(is_lost(run_of("cave", "os0", "far", 100.0, 0.0)));
  EXPECT_THAT(lost_reason(run_of("cave", "os0", "far", 101.0, 0.0)), HasSubstr("101 cm per m"));
  RunRecord turning = run_of("cave", "os0", "turning", 1.0, 0.0);
  Summary& rotation = turning.metrics->final->rpe->at_poses_1m.rotation;
  rotation = made_up::rmse_of(20.0 / kDegreesPerRadian);
  EXPECT_FALSE(is_lost(turning));
  rotation.rmse *= 1.01;
  EXPECT_THAT(lost_reason(turning), HasSubstr("20.2 degrees per m"));
  RunRecord run = run_of("cave", "os0", "gone", 1.0, 0.0);
  made_up::lose(run);
  EXPECT_EQ(lost_reason(run), "diverged: 12 m from the truth");
  EXPECT_TRUE(is_lost(RunRecord{})) << "without metrics";
}

TEST(Lost, ABadMapIsAFigure) {
  EXPECT_FALSE(is_lost(run_of("cave", "os0", "bent", 8.17, 58.0))) << "as the paper's own run";
}

TEST(Lost, IsAFigureThatIsNotFinite) {
  RunRecord run = run_of("cave", "os0", "wild", 1.0, 0.0);
  run.metrics->final->rpe->at_poses_1m.translation.rmse = std::nan("");
  EXPECT_THAT(lost_reason(run), HasSubstr("not finite"));
  EXPECT_TRUE(std::isinf(*judged_value(run, kOwnMapRmse)));
}

TEST(Lost, ARunThatEndedItselfSaysWhenAndItsDriftUntilThenIsKept) {
  StudyResults results;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    results.rows.push_back(run_of("cave", "os0", "ct_icp", 3.5, 0.0, seed));
    RunRecord& run = results.rows.back();
    run.metrics->status = run.status = "diverged";
    run.metrics->reason = run.reason = "scan 46: the algorithm reported divergence";
    run.metrics->ended_at_s = 4.6 + static_cast<double>(seed - 1);
  }
  EXPECT_EQ(lost_reason(results.rows[0]),
            "ended at 4.6 s: scan 46: the algorithm reported divergence");
  EXPECT_NEAR(*value_of(results.rows[0], kDrift), 3.5, 1e-12);
  EXPECT_TRUE(std::isinf(*judged_value(results.rows[0], kDrift)));
  const auto cell = [&](const Figure& figure) {
    return StudyCells(results, "").cell("cave", "os0", "ct_icp", figure).text;
  };
  EXPECT_EQ(cell(kDrift), "ended at 5.6 s [3.50]");
  EXPECT_EQ(cell(kOwnMapRmse), "ended at 5.6 s");
  EXPECT_EQ(StudyCells(results, "").status_text("cave", "os0", "ct_icp"), "3 of 3 ended itself");
  made_up::lose(results.rows[2]);
  EXPECT_EQ(cell(kDrift), "lost") << "one was stopped from outside";
}

TEST(StudyCells, ACellOfTheDriftHasTheLiveOneBesideIt) {
  StudyResults results;
  results.rows.push_back(run_of("cave", "os0", "good", 0.078, 0.0));
  EXPECT_EQ(StudyCells(results, "").cell("cave", "os0", "good", kDrift).live, "");
  results.rows[0].metrics->live = results.rows[0].metrics->final;
  results.rows[0].metrics->live->rpe->at_poses_1m.translation.rmse = 0.0015;
  const TableCell cell = StudyCells(results, "").cell("cave", "os0", "good", kDrift);
  EXPECT_EQ(cell.text, "0.078");
  EXPECT_EQ(cell.live, "0.15");
  EXPECT_EQ(StudyCells(results, "").cell("cave", "os0", "good", kOwnMapRmse).live, "");
}

TEST(Lost, AnExternalProgramWithoutAMapIsJudgedByItsDrift) {
  RunRecord run = run_of("cave", "os0", "theirs", 3.0, 0.0);
  run.metrics->maps.own.reset();
  EXPECT_FALSE(is_lost(run));
  run.metrics->final->rpe->at_poses_1m.translation.rmse = 1.5;
  EXPECT_TRUE(is_lost(run));
}

TEST(Lost, EveryFigureOfALostRunIsTheWorstAlsoWhereMoreIsBetter) {
  const RunRecord wild = run_of("cave", "os0", "wild", 101.0, 0.0);
  EXPECT_EQ(judged_value(wild, kDrift), std::numeric_limits<double>::infinity());
  EXPECT_EQ(judged_value(wild, figure_of("own_map_f_score", "")),
            -std::numeric_limits<double>::infinity());
  EXPECT_EQ(value_of(wild, kDrift), 101.0) << "as measured";
  EXPECT_FALSE(judged_figure(wild, kDrift).failure.empty());
}

TEST(StudyCells, APartlyFailedCellHasItsLostRunsInMedianAndRange) {
  StudyResults results;
  for (std::uint64_t seed = 1; seed <= 5; ++seed)
    results.rows.push_back(run_of("cave", "os0", "kiss_icp", static_cast<double>(seed), 0, seed));
  const auto drift = [&] {
    return StudyCells(results, "indoor").spread("cave", "os0", "kiss_icp", kDrift);
  };
  EXPECT_EQ(drift().median, 3.0);
  made_up::lose(results.rows[0]);
  EXPECT_EQ(drift().median, 4.0) << "of 2 3 4 5 lost";
  EXPECT_EQ(drift().best, 2.0);
  EXPECT_TRUE(std::isinf(*drift().worst));
  EXPECT_EQ(drift().kept, 4U);
  set_metrics(results.rows[1], made_up::metrics_of(200.0, 0.0));
  EXPECT_EQ(drift().median, 5.0) << "of 3 4 5 and two lost ones";
  set_metrics(results.rows[2], made_up::metrics_of(300.0, 0.0));
  EXPECT_TRUE(drift().is_lost()) << "three of five";
  EXPECT_EQ(StudyCells(results, "indoor").status_text("cave", "os0", "kiss_icp"),
            "1 of 5 diverged, 2 of 5 lost");
  EXPECT_FALSE(StudyCells(results, "indoor").spread("cave", "os0", "ct_icp", kDrift).median);
}

TEST(ZeroShares, HaveAnUpperBoundByTheNumberOfPoints) {
  StudyResults results;
  for (std::uint64_t seed = 1; seed <= 3; ++seed)
    results.rows.push_back(run_of("cave", "os0", "good", 1.0, 0.0, seed));
  results.rows[1].metrics->maps.own->se3.points = 3000;
  const Spread spread = StudyCells(results, "").spread("cave", "os0", "good", kOwnMapOutliers);
  EXPECT_EQ(spread.median, 0.0);
  EXPECT_EQ(spread.zero_bound, 3.0) << "of 100 points: 3 / 100 in percent";
  EXPECT_EQ(zero_bound(kOwnMapOutliers.read(*results.rows[1].metrics)), 0.1);
  EXPECT_EQ(zero_bound(kDrift.read(*results.rows[1].metrics)), std::nullopt);
  for (RunRecord& run : results.rows) set_metrics(run, made_up::metrics_of(1.0, 0.5));
  EXPECT_FALSE(StudyCells(results, "").spread("cave", "os0", "good", kOwnMapOutliers).zero_bound);
}

TEST(ZeroShares, ASampledMapSaysOfHowManyPoints) {
  RunRecord run = run_of("cave", "os0", "good", 1.0, 0.0);
  run.metrics->maps.own->se3.map_points = 250;
  EXPECT_EQ(kOwnMapOutliers.read(*run.metrics).samples, "100 of 250 points");
}

}  // namespace
}  // namespace lidarena::results
