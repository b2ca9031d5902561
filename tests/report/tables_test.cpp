// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "lidarena/report/decision.hpp"
#include "lidarena/report/figure_tables.hpp"
#include "lidarena/report/report_data.hpp"
#include "lidarena/report/simplified_mesh.hpp"
#include "lidarena/report/summary_tables.hpp"
#include "lidarena/report/web_page.hpp"
#include "lidarena/results/study_cells.hpp"
#include "lidarena/study/study_spec.hpp"
#include "tests/results/made_up_runs.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

results::RunRecord row(const std::string& world, const std::string& sensor,
                       const std::string& algorithm, double rpe, double outliers,
                       std::uint64_t seed = 1) {
  return results::made_up::run_of(world, sensor, algorithm, rpe, outliers, seed);
}

/// The paper's own figures, as if they were our runs.
results::StudyResults results_of_the_paper() {
  const study::ConfigFolder configs(std::string(LIDARENA_SOURCE_DIR) + "/configs");
  const auto spec = study::load_study(configs.resolve("studies", "paper"));
  results::StudyResults results =
      results::made_up::runs_of_reference(study::load_reference(spec, configs));
  results.expect = spec.expect;
  return results;
}

const results::Table& table_called(const std::vector<results::Table>& tables,
                                   const std::string& id) {
  for (const results::Table& table : tables) {
    if (table.id == id) return table;
  }
  throw std::runtime_error("no table " + id);
}

TEST(FigureTables, OnThePapersOwnFiguresTheMarksAreThePapers) {
  const auto tables = figure_tables(results_of_the_paper(), "indoor");
  const results::Table& drift = table_called(tables, "drift-cave-indoor");
  ASSERT_EQ(drift.head.back(), "fast_lio2");
  const results::TableCell& best =
      drift.rows.at(1).back();  // Os0-128, FAST-LIO2: bold and underlined
  EXPECT_EQ(best.text, "0.49");
  EXPECT_EQ(best.reference, "0.49");
  EXPECT_TRUE(best.underlined);
  EXPECT_TRUE(best.bold);
  EXPECT_TRUE(drift.rows.at(0).back().underlined) << "Mid-360: FAST-LIO2 is the best algorithm";
  EXPECT_FALSE(drift.rows.at(0).back().bold);
  EXPECT_TRUE(drift.rows.at(0).at(2).bold) << "KISS-ICP: the Mid-360 is the better sensor";
  const results::Table& outliers = table_called(tables, "outliers-cave-indoor");
  EXPECT_TRUE(outliers.rows.at(0).at(3).underlined) << "3.68 of LIO-SAM with loop closure";
}

TEST(FigureTables, TheIncreaseIsDividedByTheLastWorldAsInThePaper) {
  // Only this formula gives Table 3 (3.3, 32.5, 17.9, 55.8 %) from Table 2, within its rounding.
  EXPECT_NEAR(increase_of_last(2.61, 2.70), 3.3, 0.3);
  EXPECT_NEAR(increase_of_last(1.08, 1.61), 32.5, 0.5);
  EXPECT_NEAR(increase_of_last(1.24, 1.51), 17.9, 0.4);
  EXPECT_NEAR(increase_of_last(0.49, 1.11), 55.8, 0.5);
  EXPECT_NEAR(increase(0.49, 1.11), 126.5, 0.1);
}

TEST(ExpectationsTable, HasAVerdictAndTheFiguresBehindIt) {
  results::StudyResults results = results_of_the_paper();
  const results::Table table = expectations_table(results, "indoor");
  ASSERT_EQ(table.rows.size(), 12U);
  EXPECT_EQ(table.rows[0][1].text, "holds");
  EXPECT_THAT(table.rows[0][3].text, HasSubstr("cave, livox_mid360: 1.08 cm, against 1.78 cm of "));
  EXPECT_EQ(table.rows.back()[1].text, "cannot be judged") << "memory was not measured";
  for (results::RunRecord& run : results.rows) {
    if (run.algorithm == "ct_icp") set_metrics(run, results::made_up::metrics_of(0.1, 0.0));
  }
  const results::Table contrary = expectations_table(results, "indoor");
  EXPECT_EQ(contrary.rows[0][1].text, "falls short");
  EXPECT_THAT(contrary.rows[0][3].text, HasSubstr("Possible reason: keyframe smoothing"));
}

TEST(Timing, ModesStandBesideEachOtherAndAStudyOfOneHasNoSuchTables) {
  results::StudyResults results;
  for (const auto& [mode, rpe] : {std::pair{"rolling", 1.0}, {"frozen", 5.0}}) {
    results.rows.push_back(row("cave", "livox_mid360", "ct_icp", rpe, 2.0 * rpe));
    results.rows.back().mode = mode;
  }
  results.rows.push_back(row("cave", "livox_mid360", "kiss_icp", 9.0, 9.0));  // without a mode
  const std::vector<results::Table> tables = timing_tables(results);
  ASSERT_EQ(tables.size(), 3U);
  const results::Table& drift = table_called(tables, "modes-drift-cave-indoor");
  EXPECT_THAT(drift.head, testing::ElementsAre("sensor, algorithm", "rolling", "frozen"));
  ASSERT_EQ(drift.rows.size(), 1U);
  EXPECT_EQ(drift.rows[0][1].value, 1.0);
  EXPECT_EQ(drift.rows[0][2].value, 5.0);
  EXPECT_EQ(table_called(tables, "modes-outliers-cave-indoor").rows[0][2].value, 10.0);
  EXPECT_TRUE(timing_tables(results_of_the_paper()).empty());
}

TEST(StudyCells, ACellIsTheMedianOfWhatWentWellAndSaysWhatDidNot) {
  results::StudyResults results;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    results.rows.push_back(row("cave", "os0", "kiss_icp", static_cast<double>(seed), 0, seed));
  }
  results.rows[3].status = "diverged";
  const results::StudyCells cells(results, "indoor");
  EXPECT_DOUBLE_EQ(*cells.median("cave", "os0", "kiss_icp", results::kDrift), 2.0);
  EXPECT_EQ(cells.status_text("cave", "os0", "kiss_icp"), "1 of 4 diverged");
  EXPECT_FALSE(cells.median("cave", "os0", "ct_icp", results::kDrift));
}

TEST(StudyCells, MethodsWithoutPresetsAreComparedWithEveryPreset) {
  results::StudyResults results = results_of_the_paper();
  results::RunRecord ours = row("cave", "livox_mid360", "arena_lio", 0.01, 0.0);
  ours.preset = "";
  results.rows.push_back(ours);
  EXPECT_EQ(results::variants_of(results), std::vector<std::string>{"indoor"});
  EXPECT_EQ(results::StudyCells(results, "indoor").rows("cave", "livox_mid360", "arena_lio").size(),
            1U);
}

TEST(SummaryTables, AFailedRunIsARowWithItsReasonAndEveryRunHasItsCommand) {
  results::StudyResults results = results_of_the_paper();
  results.rows[2].status = "diverged";
  results.rows[2].reason = "estimate left the world";
  results.rows[2].metrics->resources.scans = 1;
  results.rows[2].metrics->resources.own.peak_bytes = 12.5e6;
  results.rows[0].simulation = Json::parse(
      R"({"seed":7,"seconds":20.0,"sensors":[{"name":"livox_mid360"},{"name":"ouster_os0_128"}]})");
  const results::Table failures = failures_table(results);
  ASSERT_EQ(failures.rows.size(), 1U);
  EXPECT_EQ(failures.rows[0][2].text, "estimate left the world");
  const results::Table runs = runs_table(results, "cave");
  ASSERT_EQ(runs.rows.at(2).size(), runs.head.size());
  EXPECT_EQ(runs.rows[2][1].text, "diverged: estimate left the world");
  EXPECT_EQ(runs.rows[2].back().value, 12.5) << "the status replaces the drift only";
  EXPECT_THAT(
      commands_table(results).rows.at(0).at(1).text,
      HasSubstr("lidarena simulate --world cave --flight cave --sensor livox_mid360 --sensor "
                "ouster_os0_128 --seed 7 --seconds 20.0 --no-data --out data && lidarena run "
                "ct_icp data --preset indoor --sensor livox_mid360"));
}

/// A run with a map RMSE and a computing time per scan; the scan period is 100 ms.
results::RunRecord tried(const std::string& sensor, const std::string& algorithm,
                         double map_rmse_cm, double p95_ms) {
  results::RunRecord r = row("mine", sensor, algorithm, 1.0, 0.0);
  r.preset = "indoor";
  results::MapInGauge& map = r.metrics->maps.reprojected.emplace().se3;
  map.points = 100;
  map.distance_m = results::made_up::rmse_of(0.01 * map_rmse_cm);
  map.outliers_percent = 0.5;
  r.metrics->resources.scans = 100;
  r.metrics->resources.latency.count = 100;
  r.metrics->resources.latency.p95 = 1e-3 * p95_ms;
  r.lidar = {{"rate_hz", 10.0}};
  r.simulation = Json::parse(
      R"({"sensors":[{"name":"cheap","facts":{"weight_kg":0.265,"price":"below 1000 EUR"}}]})");
  return r;
}

TEST(Decision, TheBestMapAmongWhatKeepsTrackInTime) {
  results::StudyResults results;
  results.rows = {tried("cheap", "slow", 1.0, 120.0), tried("cheap", "good", 3.0, 40.0),
                  tried("cheap", "lost", 0.5, 10.0), tried("dear", "good", 1.5, 60.0)};
  results.rows[2].status = "diverged";
  const std::vector<Candidate> found = candidates(results, "mine");
  ASSERT_EQ(found.size(), 4U);
  EXPECT_EQ(found[0].sensor + found[0].algorithm, "deargood");
  EXPECT_EQ(found[1].sensor + found[1].algorithm, "cheapgood");
  EXPECT_EQ(found[2].algorithm, "slow");
  EXPECT_FALSE(found[2].is_real_time());
  EXPECT_NEAR(found[2].period_share.value(), 1.2, 1e-12);
  EXPECT_EQ(found[3].algorithm, "lost");
  EXPECT_FALSE(found[3].keeps_tracking());
  const results::Table table = decision_table(results, "mine");
  EXPECT_EQ(table.rows.at(0).at(0).text, "dear, good");
  EXPECT_EQ(table.rows.at(0).at(2).value, 1.5);
  EXPECT_EQ(table.rows.at(3).at(1).text, "tracking lost in 1 of 1");
  EXPECT_EQ(facts_of(results.rows[0]).at("price"), "below 1000 EUR");
}

TEST(Decision, WhoseTimeIsNotKnownIsNotCalledUsable) {
  results::StudyResults results;
  results.rows = {tried("cheap", "theirs", 1.0, 10.0), tried("cheap", "good", 3.0, 40.0)};
  results.rows[0].metrics->resources.latency = {};
  const std::vector<Candidate> found = candidates(results, "mine");
  EXPECT_EQ(found[0].algorithm, "good");
  EXPECT_FALSE(found[1].is_usable());
  EXPECT_EQ(decision_table(results, "mine").rows.at(1).at(1).text, "time not measured");
}

TEST(Decision, AMapThatLiesElsewhereIsALostTrack) {
  results::StudyResults results;
  results.rows = {tried("cheap", "wild", 900.0, 10.0), tried("cheap", "good", 3.0, 40.0)};
  results.rows[0].metrics->maps.reprojected->se3.outliers_percent = 99.0;
  const std::vector<Candidate> found = candidates(results, "mine");
  EXPECT_EQ(found[0].algorithm, "good");
  EXPECT_FALSE(found[1].keeps_tracking());
  const results::Table table = decision_table(results, "mine");
  EXPECT_EQ(table.rows.at(1).at(1).text, "tracking lost in 1 of 1");
  EXPECT_EQ(table.rows.at(1).at(2).text, "900");
}

TEST(Decision, WhatIsTooSlowIsNotUsableAndFaultsOfSimulatorsAreNoCandidates) {
  results::StudyResults results;
  results.rows = {tried("cheap", "slow", 1.0, 120.0), tried("cheap", "good", 1.0, 10.0)};
  results.rows[1].mode = "frozen";
  ASSERT_EQ(candidates(results, "mine").size(), 1U);
  EXPECT_EQ(verdict(candidates(results, "mine").front()), "too slow for real time");
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
  EXPECT_THAT(commands_table(results).rows.at(1).at(1).text, HasSubstr(" --mode official"));
}

TEST(Results, PartsOfAStudyBecomeOneAndWhatWasScoredCounts) {
  results::StudyResults one, other;
  one.title = "the study";
  one.rows = {row("cave", "s", "a", 1.0, 0.0), row("cave", "s", "b", 0.0, 0.0)};
  other.rows = {row("cave", "s", "a", 7.0, 0.0), row("cave", "s", "b", 2.0, 0.0)};
  one.rows[1].metrics.reset();
  one.rows[1].status = "missing";
  const results::StudyResults all = results::merged({one, other});
  EXPECT_EQ(all.title, "the study");
  ASSERT_EQ(all.rows.size(), 2U);
  EXPECT_EQ(results::value_of(all.rows[0], results::kDrift), 1.0);
  EXPECT_EQ(results::value_of(all.rows[1], results::kDrift), 2.0);
}

TEST(ReportData, HasTheFiguresOfEveryRunUnderTheirKeysAndTheRankingOfWhatWasTried) {
  results::StudyResults results = results_of_the_paper();
  results.rows[1].status = "diverged";
  results.rows[1].reason = "lost";
  results.rows[1].metrics.reset();
  const Json data = report_data(results, {decision_table(results, "cave")}, ".");
  ASSERT_EQ(data.at("runs").size(), results.rows.size());
  const Json& figures = data.at("figures");
  for (std::size_t i = 0; i < results.rows.size(); ++i) {
    const Json& run = data.at("runs").at(i);
    EXPECT_EQ(run.at("name"), results.rows[i].name);
    EXPECT_EQ(run.at("status"), results.rows[i].status);
    ASSERT_EQ(run.at("values").size(), figures.size());
    for (std::size_t f = 0; f < figures.size(); ++f) {
      const auto value =
          results::value_of(results.rows[i], results::figure_of(figures.at(f).at("key"), ""));
      ASSERT_EQ(run.at("values").at(f).is_null(), !value) << figures.at(f).at("key");
      if (!value) continue;
      EXPECT_NEAR(run.at("values").at(f).get<double>(), *value, 1e-5 * *value);
    }
  }
  EXPECT_EQ(data.at("tables").at(0).at("id"), "decision-cave");
  EXPECT_EQ(data.at("decision").size(), results.rows.size()) << "every cell has one run";
  EXPECT_EQ(data.at("reference").size(), results.reference.size());
}

TEST(ReportData, ACurveKeepsItsPeakAndALongStudyHasNone) {
  results::StudyResults results = results_of_the_paper();
  results.rows.resize(1);
  results::ErrorsOverTime& errors =
      results.rows[0].metrics->final->errors_over_time.emplace().ate_se3;
  for (int i = 0; i < 3000; ++i) {
    errors.t_s.push_back(0.1 * i);
    errors.translation_m.push_back(i == 1234 ? 7.5 : 0.25);
    errors.rotation_rad.push_back(0.0);
  }
  const Json curve = report_data(results, {}, ".").at("runs").at(0).at("error");
  const auto values = curve.at("translation_m").get<std::vector<double>>();
  EXPECT_LE(values.size(), 400U);
  EXPECT_EQ(curve.at("t_s").size(), values.size());
  EXPECT_EQ(curve.at("largest_of"), 8);
  EXPECT_EQ(*std::max_element(values.begin(), values.end()), 7.5);
  results.rows.resize(6000, results.rows[0]);
  EXPECT_TRUE(report_data(results, {}, ".").at("runs").at(0).at("error").is_null());
}

TEST(WebPage, NeedsNoNetworkAndTheDataCannotBreakOutOfIt) {
  if (!has_viewer()) GTEST_SKIP() << "skipped: built without the viewer (LIDARENA_WITH_VIEWER)";
  results::StudyResults results = results_of_the_paper();
  results.title = "</title><script>alert(1)</script>";
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "page.html";
  write_page(file, {results.title, "report", report_data(results, {}, folder.path()), {}});
  std::ifstream in(file);
  const std::string page((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  EXPECT_THAT(page, HasSubstr("kiss_icp"));
  EXPECT_THAT(page, Not(HasSubstr("<script>alert")));
  for (const char* reach : {"src='http", "src=\"http", "href='http", "href=\"http", "@import"}) {
    EXPECT_THAT(page, Not(HasSubstr(reach)));
  }
}

TEST(SimplifiedMesh, AFinePlaneBecomesCoarseAndStaysWhereItIs) {
  world::TriangleMesh plane;
  constexpr std::uint32_t kSide = 200;
  for (std::uint32_t j = 0; j <= kSide; ++j) {
    for (std::uint32_t i = 0; i <= kSide; ++i) plane.vertices.emplace_back(0.05 * i, 0.05 * j, 1.0);
  }
  for (std::uint32_t j = 0; j < kSide; ++j) {
    for (std::uint32_t i = 0; i < kSide; ++i) {
      const std::uint32_t a = j * (kSide + 1) + i;
      plane.triangles.push_back({a, a + 1, a + kSide + 2});
      plane.triangles.push_back({a, a + kSide + 2, a + kSide + 1});
    }
  }
  const world::TriangleMesh coarse = simplified(plane, 3000);
  EXPECT_LE(coarse.triangles.size(), 3000U);
  EXPECT_GT(coarse.triangles.size(), 300U) << "doubling the cell size leaves about a quarter";
  // vertices move by less than a cell; 3000 triangles of a 10 m square are 0.26 m wide or less than
  // twice that
  EXPECT_NEAR(coarse.area(), plane.area(), 0.15 * plane.area());
  for (const Eigen::Vector3d& v : coarse.vertices) EXPECT_DOUBLE_EQ(v.z(), 1.0);
  EXPECT_EQ(simplified(coarse, 3000).triangles, coarse.triangles);
}

}  // namespace
}  // namespace lidarena::report
