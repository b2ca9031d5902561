// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/metrics_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "lidarena/results/run_statistics.hpp"

namespace lidarena::results {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// A summary of `count` values with this RMSE.
Summary rmse_of(double rmse, std::size_t count) {
  Summary summary;
  summary.rmse = rmse;
  summary.count = count;
  return summary;
}

/// A run with an RPE of `cm` per meter.
ScoredRun run_of(const std::string& name, const std::string& algorithm, const std::string& flight,
                 double cm) {
  ScoredRun run{name, algorithm, flight, "1", {}};
  RunMetrics& m = run.metrics;
  m.warnings = {"the estimate covers 87 % of the flight"};
  TrajectoryMetrics& final = m.final.emplace();
  final.association = {300, 290, 0.871, 26.0, 3.1, 10.0, 1000.0, {}, {}, {}};
  LeverArmMetrics& arm = final.association.lever_arm.emplace();
  arm.position_m = {0.25, -0.1, std::nullopt};
  arm.rotation_vector_rad = {0.0, 0.0, 0.1};
  RpeMetrics& rpe = final.rpe.emplace().at_poses_1m;
  rpe.definition = "rpe_1m_at_poses[ref-arc,1m,disjoint,nearest-poses,gap1.5]";
  rpe.used = 38;
  rpe.total = 45;
  rpe.translation = rmse_of(cm / 100, 38);
  rpe.rotation = rmse_of(0.01, 38);
  final.ate.emplace().se3.refused = "the flight is a line";
  final.kitti.emplace().refused = "the common path is 45 m, no piece of 100 m fits";
  m.live = m.final;
  m.resources.scans = 300;
  m.resources.latency = rmse_of(0.01, 300);
  m.resources.latency.p95 = 0.0123;
  m.resources.own.peak_bytes = 2.5e6;
  return run;
}

ScoredRun diverged(const std::string& name, const std::string& algorithm,
                   const std::string& flight) {
  ScoredRun run{name, algorithm, flight, "1", {}};
  run.metrics.status = "diverged";
  run.metrics.reason = "900 m from the truth, 50 % & more";
  return run;
}

MapScores map_of(double rmse_m) {
  MapScores map;
  map.definition = "map_error";
  map.points = 900;
  map.distance_m = rmse_of(rmse_m, 900);
  return map;
}

/// Adds a re-projected map with a recall of `percent` within 5 cm and 0 within the other distances.
ScoredRun with_map(ScoredRun run, double percent) {
  MapMetrics& map = run.metrics.maps.reprojected.emplace();
  map.se3 = map_of(0.03);
  map.robust = map_of(0.02);
  map.se3.completeness.samples = 5000;
  for (const double within : Completeness::kWithin_m) {
    map.se3.completeness.rows.push_back({within, 0.0, 0.0, 0.0});
  }
  map.se3.completeness.rows[1] = {0.05, 0.0, percent, percent - 1.0};
  map.se3.ghosting.patches = 400;
  map.se3.ghosting.double_percent = 1.5;
  map.se3.point_vertex.refused = "too many vertices";
  return run;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

TEST(MetricsText, GivesTheDiagnosisBeforeAnyNumberAndCoverageBesideEveryError) {
  const std::string text = metrics_text(run_of("run_a", "x:y", "house", 1.25));
  EXPECT_THAT(text, HasSubstr("warning: the estimate covers 87 % of the flight"));
  EXPECT_THAT(text, HasSubstr("290 of 300 poses matched, coverage 87.1 %, overlap 26.00 s"));
  EXPECT_THAT(text, HasSubstr("at 0.25 -0.1 ? m, rotated by 0 0 5.73 deg"));
  EXPECT_THAT(text, HasSubstr("SE(3) alignment refused: the flight is a line"));
  EXPECT_THAT(text, HasSubstr("refused: the common path is 45 m"));
  EXPECT_LT(text.find("coverage"), text.find("RPE per meter"));
  for (const std::string& line : lines_of(text)) {
    if (line.find("RPE per meter  ") == std::string::npos) continue;
    EXPECT_THAT(line, HasSubstr("1.250 cm"));
    EXPECT_THAT(line, HasSubstr("coverage 87 %, 38 of 45 pieces"));
  }
  EXPECT_THAT(text, Not(HasSubstr("live")));  // equal to the final one: shown once
  EXPECT_THAT(text, HasSubstr("12.300 ms"));
}

TEST(MetricsText, OfARunThatEndedItselfItSaysWhen) {
  ScoredRun run = run_of("run_a", "", "house", 1.25);
  run.metrics.status = "diverged";
  run.metrics.reason = "scan 46: the algorithm reported divergence";
  run.metrics.ended_at_s = 4.6;
  EXPECT_THAT(metrics_text(run), HasSubstr("it ended itself at 4.6 s; the figures are until then"));
}

TEST(MetricsText, AFigureThatMeansLittleSaysSo) {
  ScoredRun run = run_of("run_a", "", "house", 1.25);
  AteMetrics& ate = run.metrics.final->ate->posyaw;
  ate.warning = "the estimate's z axis is tilted by 11.5 deg";
  ate.translation = rmse_of(0.2, 300);
  EXPECT_THAT(metrics_text(run),
              HasSubstr("coverage 87 %, 300 poses (the estimate's z axis is tilted"));
}

TEST(MetricsText, LiveFiguresAreShownWhereTheyDiffer) {
  ScoredRun run = run_of("run_a", "x:y", "house", 1.25);
  run.metrics.live->rpe->at_poses_1m.translation.rmse = 0.03;
  run.metrics.live->association.coverage = 0.5;
  const std::string text = metrics_text(run);
  const std::string live = text.substr(text.find("RPE per meter, live"));
  EXPECT_THAT(live.substr(0, live.find('\n')), AllOf(HasSubstr("3.000 cm"), HasSubstr("50 %")));
}

TEST(MetricsText, HasTheMapsMeasuresInABlockOfTheirOwn) {
  const std::string text = metrics_text(with_map(run_of("run_a", "x:y", "house", 1.25), 87.5));
  const std::size_t map = text.find("\nmap\n"), resources = text.find("\nresources\n");
  ASSERT_LT(text.find("\ntrajectory\n"), map);
  ASSERT_LT(map, resources);
  const auto lines = lines_of(text.substr(map + 1, resources - map));
  ASSERT_EQ(lines.size(), 7U) << text;
  EXPECT_THAT(lines[1], AllOf(HasSubstr("RMSE "), HasSubstr("3.000 cm"), HasSubstr("900 points")));
  EXPECT_THAT(lines[2], AllOf(HasSubstr("robust alignment"), HasSubstr("2.000 cm")));
  EXPECT_THAT(lines[3], AllOf(HasSubstr("to vertices"), HasSubstr("refused: too many vertices")));
  EXPECT_THAT(lines[4], AllOf(HasSubstr("completeness at 5 cm"), HasSubstr("87.500 %"),
                              HasSubstr("coverage 87 %, 5000 samples")));
  EXPECT_THAT(lines[5], AllOf(HasSubstr("F-score at 5 cm"), HasSubstr("86.500 %")));
  EXPECT_THAT(lines[6], AllOf(HasSubstr("double walls"), HasSubstr("1.500 %   "),
                              HasSubstr("coverage 87 %, 400 patches")));
  EXPECT_EQ(metrics_text(run_of("run_a", "", "house", 1.25)).find("\nmap\n"), std::string::npos);
}

TEST(MetricsText, AMapThatIsAlignedByTheFirstPoseHasItsFiguresAndSaysSo) {
  ScoredRun run = with_map(run_of("run_a", "x:y", "house", 1.25), 87.5);
  MapMetrics& map = *run.metrics.maps.reprojected;
  map.first_pose = map.se3;
  map.se3 = {};
  map.se3.refused = "the flight is a line";
  EXPECT_THAT(metrics_text(run), HasSubstr("3.000 cm    coverage 87 %, 900 points (aligned by the "
                                           "first pose: the flight is a line)"));
}

TEST(MetricsText, OfARunThatDivergedIsItsReason) {
  EXPECT_EQ(metrics_text(diverged("bad", "x:y", "house")),
            "bad (x:y)\nstatus: diverged: 900 m from the truth, 50 % & more\n");
}

TEST(MetricsCsv, HasARowAFigureAndARowForARunWithout) {
  const auto lines = lines_of(metrics_csv(
      std::vector{run_of("a,b", "x:y", "house", 1.25), diverged("bad", "x:y", "house")}));
  ASSERT_GE(lines.size(), 4U);
  EXPECT_EQ(lines[1],
            "\"a,b\",x:y,house,1,ok,,87.100,rpe_1m_at_poses_translation,"
            "\"rpe_1m_at_poses[ref-arc,1m,disjoint,nearest-poses,gap1.5]\",1.25,cm,38,45");
  EXPECT_EQ(lines.back(), "bad,x:y,house,1,diverged,\"900 m from the truth, 50 % & more\",,,,,,,");
  for (const std::string& line : lines) {
    bool inside = false;
    int commas = 0;
    for (const char c : line) {
      if (c == '"') inside = !inside;
      if (c == ',' && !inside) ++commas;
    }
    EXPECT_EQ(commas, 12) << line;
  }
}

TEST(MetricsCsv, HasTheMapsMeasuresWithTheirDefinitions) {
  const std::string csv =
      metrics_csv(std::vector{with_map(run_of("a", "x:y", "house", 1.25), 87.5)});
  EXPECT_THAT(csv, HasSubstr("a,x:y,house,1,ok,,87.100,reprojected_map_completeness,"
                             "\"completeness[seen2cm,stratified-by-area]\",87.5,%,,\n"));
  EXPECT_THAT(csv, HasSubstr("reprojected_map_f_score,"));
  EXPECT_THAT(csv, HasSubstr("reprojected_map_rmse_robust,map_error,2,cm,900,900\n"));
  EXPECT_THAT(csv, HasSubstr("reprojected_map_double_walls,"));
  EXPECT_THAT(csv, Not(HasSubstr("identity")));  // null
  EXPECT_THAT(csv, Not(HasSubstr("vertices")));  // refused
}

TEST(MetricsMarkdown, KeepsTheFailedAndMarksNoRunAsTheBest) {
  const auto lines = lines_of(
      metrics_markdown(std::vector{run_of("a", "", "house", 2.0), run_of("b|c", "", "house", 1.0),
                                   diverged("bad", "", "house")}));
  ASSERT_EQ(lines.size(), 5U);
  EXPECT_THAT(lines[0], HasSubstr("| run | coverage % | RPE cm/m |"));
  EXPECT_THAT(lines[2], HasSubstr("| a | 87.1 | 2 |"));
  EXPECT_THAT(lines[3], HasSubstr("| b\\|c | 87.1 | 1 |"));
  EXPECT_THAT(lines[4], AllOf(HasSubstr("| bad | - | - |"), HasSubstr("diverged: 900 m")));
  for (const std::string& line : lines) EXPECT_THAT(line, Not(HasSubstr("**"))) << "single runs";
}

TEST(MetricsMarkdown, HasASecondTableOfMapsWhereMoreIsBetterForCompleteness) {
  const auto lines = lines_of(metrics_markdown(std::vector{
      with_map(run_of("a", "", "house", 2.0), 90.0), with_map(run_of("b", "", "house", 1.0), 80.0),
      run_of("c", "", "house", 3.0), diverged("bad", "", "house")}));
  ASSERT_EQ(lines.size(), 13U);
  EXPECT_EQ(lines[6], "");
  // no column for what no run has: identity, vertices
  EXPECT_EQ(lines[7],
            "| run | coverage % | robust cm | complete % | F-score % | double walls % | status |");
  EXPECT_EQ(lines[9], "| a | 87.1 | 2 | 90 | 89 | 1.50 | ok |");
  EXPECT_EQ(lines[10], "| b | 87.1 | 2 | 80 | 79 | 1.50 | ok |");
  EXPECT_EQ(lines[11], "| c | 87.1 | - | - | - | - | ok |");
  EXPECT_THAT(lines[12], HasSubstr("| bad | - | - | - | - | - | diverged: 900 m"));
}

TEST(MetricsLatex, HasASecondTableOfMaps) {
  const std::string text = metrics_latex(std::vector{
      with_map(run_of("a", "", "house", 2.0), 80.0), with_map(run_of("b", "", "house", 1.0), 90.0),
      with_map(run_of("c", "", "house", 3.0), 70.0)});
  const std::size_t second = text.find("\\end{tabular}\n\n\\begin{tabular}{lrrrrrl}\n");
  ASSERT_NE(second, std::string::npos) << text;
  const std::string map = text.substr(second);
  EXPECT_THAT(map, HasSubstr("run & coverage \\% & robust cm & complete \\% & F-score \\%"));
  EXPECT_THAT(map, HasSubstr("a & 87.1 & 2 & 80 & 79 &"));
  EXPECT_THAT(map, HasSubstr("b & 87.1 & 2 & 90 & 89 &"));
  EXPECT_THAT(map, HasSubstr("c & 87.1 & 2 & 70 & 69 &"));
  EXPECT_THAT(metrics_latex(std::vector{run_of("a", "", "house", 2.0)}),
              Not(HasSubstr("robust cm")));
}

TEST(MetricsLatex, IsABooktabsTableWithFailuresInWords) {
  const std::string text =
      metrics_latex(std::vector{run_of("a_1", "", "house", 3.0), run_of("b", "", "house", 1.0),
                                run_of("c", "", "house", 2.0), diverged("bad", "", "house")});
  EXPECT_THAT(text, AllOf(HasSubstr("\\begin{tabular}{lr"), HasSubstr("\\toprule"),
                          HasSubstr("\\midrule"), HasSubstr("\\bottomrule\n\\end{tabular}\n")));
  EXPECT_THAT(text, HasSubstr("a\\_1 & 87.1 & 3 &"));
  EXPECT_THAT(text, HasSubstr("b & 87.1 & 1 &"));
  EXPECT_THAT(text, HasSubstr("c & 87.1 & 2 &"));
  EXPECT_THAT(text, HasSubstr("& diverged: 900 m from the truth, 50 \\% \\& more \\\\"));
  // every row has as many cells as the head
  std::size_t columns = 0;
  for (const std::string& line : lines_of(text)) {
    if (line.find(" & ") == std::string::npos) continue;
    std::size_t cells = 1;
    for (std::size_t at = line.find(" & "); at != std::string::npos;
         at = line.find(" & ", at + 1)) {
      ++cells;
    }
    if (columns == 0) columns = cells;
    EXPECT_EQ(cells, columns) << line;
  }
}

TEST(Statistics, AreByAlgorithmWithEveryFailureNamedAndPairedWhereThereAreTwo) {
  std::vector<ScoredRun> runs;
  for (int i = 0; i < 4; ++i) {
    const std::string flight = "flight" + std::to_string(i);
    runs.push_back(run_of("a" + flight, "first", flight, 2.0 + i));
    runs.push_back(i == 3 ? diverged("b" + flight, "second", flight)
                          : run_of("b" + flight, "second", flight, 1.5 + i));
  }
  const Json json = to_json(statistics_of(runs));
  const Json& first = json["algorithms"]["first"]["rpe_1m_at_poses_translation"];
  EXPECT_NEAR(first["median"], 3.5, 1e-9);
  EXPECT_EQ(first["flights"], 4);
  EXPECT_TRUE(first["median_95"].is_null()) << "of four flights";
  const Json& second = json["algorithms"]["second"]["rpe_1m_at_poses_translation"];
  EXPECT_EQ(second["runs"], 4);
  EXPECT_EQ(second["kept"], 3);
  EXPECT_NEAR(second["median"], 3.0, 1e-9) << "of 1.5 2.5 3.5 lost";
  EXPECT_EQ(second["worst"], "lost");
  EXPECT_EQ(second["failures"][0], "flight3 1: diverged: 900 m from the truth, 50 % & more");
  const Json& paired = json["paired"]["figures"]["rpe_1m_at_poses_translation"];
  EXPECT_EQ(paired["pairs"], 4);
  EXPECT_NEAR(paired["median_difference"], -0.5, 1e-9);
  // three of about -0.5 have the ranks 1 to 3, the lost run rank 4: 7 of the 16 sign patterns have
  // a sum of 4 or less
  EXPECT_NEAR(paired["wilcoxon_p"], 0.875, 1e-12);
  EXPECT_EQ(paired["missing"].size(), 0U);
  const std::string text = statistics_text(statistics_of(runs));
  EXPECT_THAT(text, HasSubstr("second minus first, on the same flights and seeds"));
  EXPECT_THAT(text, HasSubstr("no value: flight3 1: diverged"));
  EXPECT_THAT(text, HasSubstr("3 of 4 runs"));
  // a refused figure has its reason
  EXPECT_EQ(json["algorithms"]["first"]["ate_se3_translation"]["failures"][0],
            "flight0 1: the flight is a line");
  for (const char* flight : {"flight4", "flight5"})
    runs.push_back(run_of("a", "first", flight, 6.0));
  const Json of_six = to_json(statistics_of(runs))["algorithms"]["first"];
  EXPECT_EQ(of_six["rpe_1m_at_poses_translation"]["median_95"].size(), 2U);
}

TEST(Statistics, OfWhatIsBetterWhenLargeCountFailuresBelowAndSayWhyTheWholeAlignmentWasRefused) {
  std::vector<ScoredRun> runs;
  for (const double percent : {70.0, 80.0, 90.0}) {
    const std::string flight = "flight" + std::to_string(runs.size());
    runs.push_back(with_map(run_of(flight, "x", flight, 1.0), percent));
  }
  runs.push_back(diverged("bad", "x", "flight3"));
  runs.push_back(run_of("line", "x", "flight4", 1.0));
  runs.back().metrics.maps.reprojected.emplace().se3.refused = "the flight is a line";
  const Json json = to_json(statistics_of(runs));
  const Json& recall = json["algorithms"]["x"]["reprojected_map_completeness"];
  EXPECT_NEAR(recall["median"], 75.0, 1e-9) << "of lost 70 80 90";
  EXPECT_EQ(recall["worst"], "lost");
  EXPECT_EQ(recall["failures"][1], "flight4 1: the flight is a line");
}

}  // namespace
}  // namespace lidarena::results
