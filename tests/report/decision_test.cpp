// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/decision.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lidarena/report/summary_tables.hpp"
#include "lidarena/results/study_cells.hpp"
#include "tests/results/made_up_runs.hpp"

namespace lidarena::report {
namespace {

using ::testing::HasSubstr;

/// A run with a map RMSE and a CPU time, in % of one core.
results::RunRecord tried(const std::string& sensor, const std::string& algorithm,
                         double map_rmse_cm, double cpu_percent, std::uint64_t seed = 1) {
  results::RunRecord r = results::made_up::run_of("mine", sensor, algorithm, 1.0, 0.0, seed);
  results::MapScores& map = r.metrics->maps.reprojected.emplace().se3;
  map.points = 100;
  map.distance_m = results::made_up::rmse_of(0.01 * map_rmse_cm);
  map.outliers_percent = 0.5;
  r.metrics->resources.scans = 100;
  r.metrics->resources.cpu_load_percent = cpu_percent;
  r.metrics->resources.cpu_late_scans = cpu_percent > 100.0 ? 1.0 : 0.0;
  r.simulation.emplace().sensors = {
      Json::parse(R"({"name":"cheap","facts":{"weight_kg":0.265,"price":"below 1000 EUR"}})"),
      Json::parse(R"({"name":"dear","facts":{"weight_kg":0.4,"price":"above 10000 EUR"}})")};
  return r;
}

const Candidate& candidate_of(const std::vector<Candidate>& all, const std::string& sensor,
                              const std::string& algorithm) {
  for (const Candidate& c : all)
    if (c.sensor == sensor && c.algorithm == algorithm) return c;
  throw std::runtime_error("no such candidate");
}

TEST(Decision, TheFrontIsWhatNothingElseBeatsInAllCriteria) {
  results::StudyResults results;
  results.rows = {tried("cheap", "exact", 1.0, 90.0), tried("cheap", "quick", 3.0, 40.0),
                  tried("cheap", "poor", 3.5, 95.0), tried("dear", "best", 0.5, 60.0),
                  tried("dear", "exact", 1.0, 90.0)};
  const std::vector<Candidate> found = candidates(results, "mine");
  EXPECT_TRUE(candidate_of(found, "cheap", "exact").on_front);
  EXPECT_TRUE(candidate_of(found, "cheap", "quick").on_front) << "less CPU time";
  EXPECT_TRUE(candidate_of(found, "dear", "best").on_front) << "the better map";
  const Candidate& poor = candidate_of(found, "cheap", "poor");
  EXPECT_FALSE(poor.on_front);
  EXPECT_THAT(poor.dominated_by, HasSubstr("better in the medians of map RMSE, CPU (untested, one "
                                           "run a cell: no claim)"));
  EXPECT_THAT(candidate_of(found, "dear", "exact").dominated_by, HasSubstr("cheap, exact: as good"))
      << "the same figures, but heavier and dearer";
  EXPECT_EQ(poor.values.at(5), 1000.0) << "the number in the price";
  const results::Table table = decision_table(results, "mine");
  EXPECT_EQ(table.rows.at(0).at(2).text, "on it");
  ASSERT_EQ(table.rows.at(0).size(), table.head.size());
  EXPECT_THAT(table.rows.back().at(2).text, HasSubstr("dominated by"));
}

TEST(Decision, OutliersOfTheMapOfAllReturnsDoNotRank) {
  results::StudyResults results;
  results.rows = {tried("cheap", "a", 1.0, 10.0), tried("cheap", "b", 2.0, 20.0)};
  results.rows[0].metrics->maps.reprojected->se3.outliers_percent = 99.0;
  EXPECT_TRUE(candidate_of(candidates(results, "mine"), "cheap", "a").on_front);
  EXPECT_FALSE(candidate_of(candidates(results, "mine"), "cheap", "b").on_front);
}

TEST(Decision, WhatLosesOneRunIsNotOnTheFrontHoweverGoodTheOthers) {
  results::StudyResults results;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    results.rows.push_back(tried("cheap", "risky", 0.5, 10.0, seed));
    results.rows.push_back(tried("cheap", "safe", 3.0, 40.0, seed));
  }
  set_metrics(results.rows[0], results::made_up::metrics_of(101.0, 0.0));
  const std::vector<Candidate> found = candidates(results, "mine");
  EXPECT_EQ(found[0].algorithm, "safe");
  EXPECT_FALSE(found[1].on_front);
  EXPECT_EQ(verdict(found[1]), "lost in 1 of 3");
  EXPECT_EQ(found[1].cells.at(1).spread, "0.5 to lost, 2 of 3");
}

TEST(Decision, DominanceIsSaidWithItsLevelWhereEnoughPairsPassTheTest) {
  results::StudyResults results;
  for (std::uint64_t seed = 1; seed <= 16; ++seed) {
    const double map_cm = 1.0 + 0.01 * static_cast<double>(seed);
    results.rows.push_back(tried("cheap", "good", map_cm, 10.0, seed));
    results.rows.push_back(tried("cheap", "bad", 2.0 * map_cm, 20.0, seed));
  }
  EXPECT_THAT(candidate_of(candidates(results, "mine"), "cheap", "bad").dominated_by,
              testing::MatchesRegex(
                  "cheap, good: better in map RMSE .ratio 2(.0)? .2(.0)? to "
                  "2(.0)?.., CPU .ratio 2(.0)? .2(.0)? to 2(.0)?.. .5 % level, 16 pairs."));
  for (std::size_t i = 1; i < results.rows.size(); i += 4)  // half of the other's CPU times: 5 %
    results.rows[i].metrics->resources.cpu_load_percent = 5.0 + static_cast<double>(i) * 0.01;
  results.rows[3].metrics->resources.cpu_load_percent = 21.0;
  EXPECT_THAT(candidate_of(candidates(results, "mine"), "cheap", "bad").dominated_by,
              testing::ContainsRegex(
                  "better in map RMSE .ratio .*. .5 % level.; better in the medians of CPU .not "
                  "shown by the test, 16 pairs."));
}

TEST(Decision, WhatIsNotKnownOfOneAloneDominatesNothing) {
  results::StudyResults results;
  results.rows = {tried("cheap", "theirs", 1.0, 10.0), tried("cheap", "good", 3.0, 40.0)};
  results.rows[0].metrics->resources = {};
  const std::vector<Candidate> found = candidates(results, "mine");
  EXPECT_TRUE(found[0].on_front && found[1].on_front);
  EXPECT_EQ(verdict(candidate_of(found, "cheap", "theirs")), "time not measured");
}

TEST(Decision, RealTimeIsJudgedByCpuTimeOnOneCoreAndInPacedRunsByTheClock) {
  results::StudyResults results;
  results.rows = {tried("cheap", "slow", 1.0, 120.0)};
  results.rows[0].metrics->resources.late_scans = 0.0;
  const auto words = [&] { return verdict(candidates(results, "mine").front()); };
  EXPECT_EQ(words(), "too slow for one core");
  results.rows[0].manifest.emplace().paced = true;
  EXPECT_EQ(words(), "real time on one core");
  results.rows[0].metrics->resources.late_scans = 0.1;
  EXPECT_EQ(words(), "too slow for one core");
}

TEST(Decision, FaultsOfSimulatorsAreNoCandidates) {
  results::StudyResults results;
  results.rows = {tried("cheap", "slow", 1.0, 120.0), tried("cheap", "good", 1.0, 10.0)};
  results.rows[1].mode = "frozen";
  ASSERT_EQ(candidates(results, "mine").size(), 1U);
}

TEST(Readings, ModesOfTheSensorsStayApart) {
  results::StudyResults results;
  results.rows = {tried("cheap", "good", 3.0, 40.0), tried("cheap", "good", 9.0, 40.0)};
  results.rows[0].mode = "rolling";
  results.rows[1].mode = "official";
  EXPECT_THAT(results::variants_of(results),
              ::testing::ElementsAre("indoor-rolling", "indoor-official"));
  const results::StudyCells cells(results, "indoor-official");
  EXPECT_EQ(cells.rows("mine", "cheap", "good").size(), 1U);
  results.rows[1].simulation.emplace();
  EXPECT_THAT(commands_table(results).rows.at(1).at(1).text, HasSubstr(" --mode official"));
}

}  // namespace
}  // namespace lidarena::report
