// SPDX-License-Identifier: BSD-3-Clause
// The studies whose expectations are the findings of a publication.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "lidarena/study/study_spec.hpp"
#include "tests/results/made_up_runs.hpp"
#include "tests/study/configs.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::study {
namespace {

using ::testing::HasSubstr;

StudySpec paper() { return load_study(configs().resolve("studies", "paper")); }

/// The paper's own figures as if they were our runs.
results::StudyResults published() {
  const StudySpec spec = paper();
  results::StudyResults results =
      results::made_up::runs_of_reference(load_reference(spec, configs()));
  results.expect = spec.expect;
  return results;
}

TEST(PaperStudy, HasTheFiguresOfThreeTablesAndTwelveFindings) {
  const results::StudyResults results = published();
  EXPECT_EQ(results.rows.size(), 20U);
  EXPECT_EQ(results.reference.size(), 3 * 20U + 4U);
  EXPECT_EQ(results.expect.size(), 12U);
  EXPECT_FALSE(planned_cells(paper(), configs()).empty());
  const StudySpec full = load_study(configs().resolve("studies", "paper_full"));
  EXPECT_EQ(full.expect.size(), 12U) << "those of its base";
  EXPECT_EQ(planned_cells(full, configs()).size(), 20U * 10U) << "20 cells in ten pairs of worlds";
  for (const PlannedRun& cell : planned_cells(full, configs())) EXPECT_NE(cell.seed, 1U);
}

TEST(PaperStudy, AllThatFiguresCanJudgeHoldsOnThePapersOwn) {
  for (const results::Judgement& judged : results::judge(published(), "indoor")) {
    if (judged.expectation.finding.find("memory") != std::string::npos) {
      EXPECT_FALSE(judged.holds) << "there are no measurements over time";
    } else {
      EXPECT_EQ(judged.holds, true) << judged.expectation.finding;
      EXPECT_FALSE(judged.evidence.empty()) << judged.expectation.finding;
    }
  }
}

TEST(PaperStudy, IsAboutTheMethodsOfThePaperAlone) {
  results::StudyResults results = published();
  results::RunRecord ours =
      results::made_up::run_of("cave", "livox_mid360_paper", "arena_lio", 0.01, 0.0);
  ours.preset = "";
  results.rows.push_back(ours);
  const std::vector<results::Judgement> judged = results::judge(results, "indoor");
  EXPECT_EQ(judged[0].holds, true) << "the lowest drift of the paper's methods";
}

TEST(PaperStudy, MemoryThatGrowsLinearlyIsToldFromMemoryThatStops) {
  results::StudyResults results = published();
  const auto with = [&](double r_squared) {
    for (results::RunRecord& run : results.rows) {
      results::RunMetrics metrics = *run.metrics;
      metrics.resources.scans = 100;
      metrics.resources.own.growth_r_squared = r_squared;
      set_metrics(run, metrics);
    }
    return results::judge(results, "indoor").back().holds;
  };
  EXPECT_EQ(with(0.99), true);
  EXPECT_EQ(with(0.5), false);
}

TEST(LoadReference, NamesFileAndLineOfWhatIsWrong) {
  const TemporaryFolder folder;
  StudySpec spec;
  spec.reference = (folder.path() / "known.csv").string();
  const auto refusal = [&](const std::string& text) {
    std::ofstream(spec.reference) << text;
    try {
      load_reference(spec, configs());
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_THAT(refusal("world,sensor,value\n"), HasSubstr("known.csv:1: is not the header"));
  EXPECT_THAT(refusal("world,sensor,algorithm,figure,value\na,b,c\n"),
              HasSubstr("known.csv:2: holds 3 columns, not 5"));
  EXPECT_THAT(refusal("world,sensor,algorithm,figure,value\na,b,c,d,many\n"),
              HasSubstr("known.csv:2"));
  EXPECT_EQ(refusal("world,sensor,algorithm,figure,value\na,b,c,d,1.5\n"), "accepted");
}

}  // namespace
}  // namespace lidarena::study
