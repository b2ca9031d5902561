// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/metrics_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "lidarena/evaluation/run_statistics.hpp"

namespace lidarena {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// A run with an RPE of `cm` per metre, as metrics.json has it.
ScoredRun run_of(const std::string& name, const std::string& algorithm, const std::string& flight,
                 double cm) {
  ScoredRun run{name, algorithm, flight, "1", Json::object()};
  Json& m = run.metrics;
  m["status"] = "ok";
  m["reason"] = "";
  m["warnings"] = Json::array({"the estimate covers 87 % of the flight"});
  m["final"]["association"] = {{"matched", 290},          {"estimates", 300},
                               {"coverage", 0.871},       {"overlap_s", 26.0},
                               {"longest_gap_s", 3.1},    {"estimate_rate_hz", 10.0},
                               {"truth_rate_hz", 1000.0}, {"time_offset_s", nullptr}};
  m["final"]["association"]["lever_arm"] = {{"position_m", {0.25, -0.1, nullptr}},
                                            {"rotation_vector_rad", {0.0, 0.0, 0.1}}};
  m["final"]["rpe"]["1m"] = {{"definition", "rpe_1m[ref-arc,1m,disjoint,interp,gap1.5]"},
                             {"used", 38},
                             {"total", 45},
                             {"translation", {{"rmse_m", cm / 100}, {"count", 38}}},
                             {"rotation", {{"rmse_rad", 0.01}}}};
  m["final"]["ate"]["se3"] = {{"refused", "the flight is a line"}, {"translation", nullptr}};
  m["final"]["kitti"] = {{"refused", "the common path is 45 m, no piece of 100 m fits"}};
  m["live"] = m["final"];
  m["resources"] = {{"latency", {{"p95_s", 0.0123}}}, {"own", {{"peak_bytes", 2.5e6}}}};
  return run;
}

ScoredRun diverged(const std::string& name, const std::string& algorithm,
                   const std::string& flight) {
  return {name,
          algorithm,
          flight,
          "1",
          {{"status", "diverged"}, {"reason", "900 m from the truth, 50 % & more"}}};
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
  EXPECT_THAT(text, HasSubstr("at 0.25 -0.1 ? m, turned by 0 0 5.73 deg"));
  EXPECT_THAT(text, HasSubstr("SE(3) gauge refused: the flight is a line"));
  EXPECT_THAT(text, HasSubstr("refused: the common path is 45 m"));
  EXPECT_LT(text.find("coverage"), text.find("RPE per metre"));
  for (const std::string& line : lines_of(text)) {
    if (line.find("RPE per metre  ") == std::string::npos) continue;
    EXPECT_THAT(line, HasSubstr("1.250 cm"));
    EXPECT_THAT(line, HasSubstr("coverage 87 %, 38 of 45 pieces"));
  }
  EXPECT_THAT(text, Not(HasSubstr("live")));  // the same as the final one: said once
  EXPECT_THAT(text, HasSubstr("12.300 ms"));
}

TEST(MetricsText, AFigureThatMeansLittleSaysSo) {
  ScoredRun run = run_of("run_a", "", "house", 1.25);
  run.metrics["final"]["ate"]["posyaw"] = {{"warning", "the estimate's z axis leans 11.5 deg"},
                                           {"translation", {{"rmse_m", 0.2}, {"count", 300}}}};
  EXPECT_THAT(metrics_text(run),
              HasSubstr("coverage 87 %, 300 poses (the estimate's z axis leans"));
}

TEST(MetricsText, LiveFiguresAreShownWhereTheyDiffer) {
  ScoredRun run = run_of("run_a", "x:y", "house", 1.25);
  run.metrics["live"]["rpe"]["1m"]["translation"]["rmse_m"] = 0.03;
  run.metrics["live"]["association"]["coverage"] = 0.5;
  const std::string text = metrics_text(run);
  const std::string live = text.substr(text.find("RPE per metre, live"));
  EXPECT_THAT(live.substr(0, live.find('\n')), AllOf(HasSubstr("3.000 cm"), HasSubstr("50 %")));
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
            "\"a,b\",x:y,house,1,ok,,87.100,rpe_1m_translation,"
            "\"rpe_1m[ref-arc,1m,disjoint,interp,gap1.5]\",1.25,cm,38,45");
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

TEST(MetricsMarkdown, MarksTheBestOfSeveralAndKeepsTheFailed) {
  const auto lines = lines_of(
      metrics_markdown(std::vector{run_of("a", "", "house", 2.0), run_of("b|c", "", "house", 1.0),
                                   diverged("bad", "", "house")}));
  ASSERT_EQ(lines.size(), 5U);
  EXPECT_THAT(lines[0], HasSubstr("| run | coverage % | RPE cm/m |"));
  EXPECT_THAT(lines[2], HasSubstr("| a | 87.1 | 2 |"));
  EXPECT_THAT(lines[3], HasSubstr("| b\\|c | 87.1 | **1** |"));
  EXPECT_THAT(lines[4], AllOf(HasSubstr("| bad | - | - |"), HasSubstr("diverged: 900 m")));
  // of one run nothing is the best
  EXPECT_THAT(metrics_markdown(std::vector{run_of("a", "", "house", 2.0)}), Not(HasSubstr("**")));
}

TEST(MetricsLatex, IsABooktabsTableWithBestAndSecondBestAndFailuresInWords) {
  const std::string text =
      metrics_latex(std::vector{run_of("a_1", "", "house", 3.0), run_of("b", "", "house", 1.0),
                                run_of("c", "", "house", 2.0), diverged("bad", "", "house")});
  EXPECT_THAT(text, AllOf(HasSubstr("\\begin{tabular}{lr"), HasSubstr("\\toprule"),
                          HasSubstr("\\midrule"), HasSubstr("\\bottomrule\n\\end{tabular}\n")));
  EXPECT_THAT(text, HasSubstr("a\\_1 & 87.1 & 3 &"));
  EXPECT_THAT(text, HasSubstr("b & 87.1 & \\textbf{1} &"));
  EXPECT_THAT(text, HasSubstr("c & 87.1 & \\underline{2} &"));
  EXPECT_THAT(text, HasSubstr("{l}{diverged: 900 m from the truth, 50 \\% \\& more} \\\\"));
  // every row has as many cells as the head
  std::size_t columns = 0;
  for (const std::string& line : lines_of(text)) {
    if (line.find(" & ") == std::string::npos || line.find("multicolumn") != std::string::npos) {
      continue;
    }
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
  const Json json = statistics_json(runs);
  const Json& first = json["algorithms"]["first"]["rpe_1m_translation"];
  EXPECT_NEAR(first["median"], 3.5, 1e-9);
  EXPECT_EQ(first["flights"], 4);
  EXPECT_FALSE(first["median_95"].is_null());
  const Json& second = json["algorithms"]["second"]["rpe_1m_translation"];
  EXPECT_EQ(second["runs"], 4);
  EXPECT_EQ(second["values"], 3);
  EXPECT_EQ(second["failures"][0], "flight3 1: diverged: 900 m from the truth, 50 % & more");
  const Json& paired = json["paired"]["figures"]["rpe_1m_translation"];
  EXPECT_EQ(paired["pairs"], 3);
  EXPECT_NEAR(paired["median_difference"], -0.5, 1e-9);
  EXPECT_NEAR(paired["wilcoxon_p"], 0.25, 1e-12);
  EXPECT_EQ(paired["missing"].size(), 1U);
  const std::string text = statistics_text(json);
  EXPECT_THAT(text, HasSubstr("second minus first, on the same flights and seeds"));
  EXPECT_THAT(text, HasSubstr("without: flight3 1: diverged"));
  EXPECT_THAT(text, HasSubstr("3 of 4 runs"));
  // a figure that was refused says why
  EXPECT_EQ(json["algorithms"]["first"]["ate_se3_translation"]["failures"][0],
            "flight0 1: the flight is a line");
}

}  // namespace
}  // namespace lidarena
