// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/lost.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "lidarena/results/study_cells.hpp"
#include "made_up_runs.hpp"

namespace lidarena::results {
namespace {

using made_up::run_of;
using ::testing::HasSubstr;

TEST(Lost, IsWhatHasNoResultNoMapOrDriftsByMoreThanItMoves) {
  EXPECT_FALSE(is_lost(run_of("cave", "os0", "good", 1.0, 50.0)));
  EXPECT_THAT(lost_reason(run_of("cave", "os0", "wild", 1.0, 50.1)),
              HasSubstr("50 % of its own map lie beyond 20 cm"));
  EXPECT_FALSE(is_lost(run_of("cave", "os0", "far", 100.0, 0.0)));
  EXPECT_THAT(lost_reason(run_of("cave", "os0", "far", 101.0, 0.0)), HasSubstr("101 cm per m"));
  RunRecord run = run_of("cave", "os0", "gone", 1.0, 0.0);
  made_up::lose(run);
  EXPECT_EQ(lost_reason(run), "diverged: 12 m from the truth");
  run = RunRecord{};
  run.status = "missing";
  EXPECT_TRUE(is_lost(run)) << "planned, but without a result";
  EXPECT_TRUE(is_lost(RunRecord{})) << "without metrics";
}

TEST(Lost, AnExternalProgramWithoutAMapIsJudgedByItsDrift) {
  RunRecord run = run_of("cave", "os0", "theirs", 3.0, 0.0);
  run.metrics->maps.own.reset();
  EXPECT_FALSE(is_lost(run));
  run.metrics->final->rpe->at_poses_1m.translation.rmse = 1.5;
  EXPECT_TRUE(is_lost(run));
}

TEST(Lost, EveryFigureOfALostRunIsTheWorstAlsoWhereMoreIsBetter) {
  const RunRecord wild = run_of("cave", "os0", "wild", 1.0, 60.0);
  EXPECT_EQ(judged_value(wild, kDrift), std::numeric_limits<double>::infinity());
  EXPECT_EQ(judged_value(wild, figure_of("own_map_f_score", "")),
            -std::numeric_limits<double>::infinity());
  EXPECT_EQ(value_of(wild, kDrift), 1.0) << "as measured";
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
  set_metrics(results.rows[1], made_up::metrics_of(2.0, 90.0));
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
