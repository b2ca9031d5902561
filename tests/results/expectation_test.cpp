// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/expectation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lidarena/base/config.hpp"
#include "tests/results/made_up_runs.hpp"

namespace lidarena::results {
namespace {

using made_up::run_of;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// The expectation written as in a study's file.
Expectation expectation(const std::string& yaml) {
  Expectation e;
  read_config(ConfigNode::parse(yaml, "study.yaml"), e);
  return e;
}

/// Two worlds, two sensors, two algorithms: `good` drifts 1 cm per m, `bad` 2 cm; twice as much
/// with the cheap sensor, and three times as much in the cave.
StudyResults eight_runs() {
  StudyResults results;
  for (const auto& [world, w] : {std::pair{"room", 1.0}, {"cave", 3.0}}) {
    for (const auto& [sensor, s] : {std::pair{"dear", 1.0}, {"cheap", 2.0}}) {
      for (const auto& [algorithm, a] : {std::pair{"good", 1.0}, {"bad", 2.0}}) {
        results.rows.push_back(run_of(world, sensor, algorithm, w * s * a, 10.0 * a));
      }
    }
  }
  return results;
}

Judgement judged(StudyResults results, const std::string& yaml) {
  results.expect = {expectation("{figure: rpe_1m_at_poses_translation, " + yaml + "}")};
  return judge(results, "indoor").at(0);
}

TEST(Expectation, LimitsHoldInAllCellsOrInSome) {
  EXPECT_EQ(judged(eight_runs(), "below: 12.1").holds, true);
  EXPECT_EQ(judged(eight_runs(), "below: 11.9").holds, false);
  EXPECT_EQ(judged(eight_runs(), "below: 11.9, cells: some").holds, true);
  EXPECT_EQ(judged(eight_runs(), "above: 12.1, cells: some").holds, false);
  EXPECT_EQ(judged(eight_runs(), "above: 2.9, below: 12.1, where: {world: [cave]}").holds, true);
  const Judgement one = judged(eight_runs(),
                               "above: 0, where: {world: [room], sensor: [dear], "
                               "algorithm: [good]}");
  EXPECT_THAT(one.evidence, ElementsAre("room, dear, good: 1 cm"));
}

TEST(Expectation, RatiosCompareWorldsSensorsOrAlgorithms) {
  const std::string sensors = "ratio: {of: {sensor: cheap}, to: {sensor: dear}}, ";
  EXPECT_EQ(judged(eight_runs(), sensors + "above: 1.99, below: 2.01").holds, true);
  EXPECT_EQ(judged(eight_runs(), sensors + "above: 2.01").holds, false);
  EXPECT_EQ(judged(eight_runs(), sensors + "above: 0").evidence.size(), 4U);
  EXPECT_EQ(judged(eight_runs(),
                   "ratio: {of: {world: cave}, to: {world: room}}, above: 2.99, below: 3.01")
                .holds,
            true);
  const Judgement one = judged(eight_runs(),
                               "ratio: {of: {algorithm: bad}, to: {algorithm: good}}, "
                               "above: 1, where: {world: [cave], sensor: [cheap]}");
  EXPECT_THAT(one.evidence, ElementsAre("cave, cheap: 12 cm with bad, 6 cm with good"));
}

TEST(Expectation, TheBestIsComparedWithItsRivalsInEachPlace) {
  EXPECT_EQ(judged(eight_runs(), "lowest: {algorithm: good}").holds, true);
  EXPECT_EQ(judged(eight_runs(), "highest: {sensor: cheap}").holds, true);
  EXPECT_EQ(judged(eight_runs(), "lowest: {world: cave}").holds, false);
  StudyResults results = eight_runs();
  set_metrics(results.rows[1], made_up::metrics_of(0.5, 0.0));  // bad in the room with dear
  const Judgement one = judged(results, "lowest: {algorithm: good}");
  EXPECT_EQ(one.holds, false);
  EXPECT_EQ(judged(results, "lowest: {algorithm: good}, cells: some").holds, true);
  EXPECT_EQ(one.evidence.at(0), "room, dear: 1 cm, against 0.5 cm of bad");
  std::erase_if(results.rows, [](const RunRecord& run) { return run.algorithm == "bad"; });
  EXPECT_FALSE(judged(results, "lowest: {algorithm: good}").holds) << "there is no rival";
}

TEST(Expectation, ALostCellIsTheWorstAndTwoLostOnesAreNotCompared) {
  StudyResults results = eight_runs();
  made_up::lose(results.rows[0]);  // good in the room with the dear sensor
  const std::string place = ", where: {world: [room], algorithm: [good]}";
  const std::string ratio = "ratio: {of: {sensor: cheap}, to: {sensor: dear}}, above: 1";
  const Judgement diverged = judged(results, ratio + place);
  EXPECT_EQ(diverged.holds, false) << "2 cm with the cheap one, lost with the dear one";
  EXPECT_THAT(diverged.evidence,
              ElementsAre("room, good: 2 cm with cheap, lost (diverged) with dear"));
  EXPECT_EQ(judged(results, "below: 100" + place).holds, false);
  EXPECT_EQ(judged(results, "lowest: {algorithm: good}").holds, false);
  EXPECT_EQ(judged(results, "lowest: {algorithm: good}").evidence.at(0),
            "room, dear: lost (diverged), against 2 cm of bad");
  results = eight_runs();
  for (RunRecord& run : results.rows) set_metrics(run, made_up::metrics_of(300.0, 0.0));
  EXPECT_FALSE(judged(results, ratio + place).holds);
  EXPECT_THAT(judged(results, ratio + place).evidence.at(0), HasSubstr("lost with both"));
}

TEST(Expectation, OfAPartlyFailedCellTheLostRunsCount) {
  StudyResults results;
  for (std::uint64_t seed = 1; seed <= 3; ++seed)
    results.rows.push_back(run_of("room", "dear", "good", static_cast<double>(seed), 0.0, seed));
  EXPECT_EQ(judged(results, "below: 2.5").holds, true) << "median of 1 2 3";
  made_up::lose(results.rows[0]);
  const Judgement one = judged(results, "below: 2.5");
  EXPECT_EQ(one.holds, false) << "median of 2 3 lost";
  EXPECT_THAT(one.evidence, ElementsAre("room, dear, good: 3 cm (1 of 3 diverged)"));
  made_up::lose(results.rows[1]);
  EXPECT_EQ(judged(results, "below: 1000").holds, false);
}

TEST(Expectation, WhatWasNotMeasuredOrHasNothingToCompareIsNotJudged) {
  StudyResults results = eight_runs();
  const std::string place = ", where: {world: [room], algorithm: [good]}";
  const std::string ratio = "ratio: {of: {sensor: cheap}, to: {sensor: dear}}, above: 1";
  for (RunRecord& run : results.rows) run.metrics->final->rpe.reset();
  EXPECT_FALSE(judged(results, "above: 0" + place).holds);
  EXPECT_THAT(judged(results, "above: 0" + place).evidence.at(0), HasSubstr("good not measured"));
  for (RunRecord& run : results.rows) set_metrics(run, made_up::metrics_of(0.0, 0.0));
  EXPECT_FALSE(judged(results, ratio + place).holds);
  EXPECT_THAT(judged(results, ratio + place).evidence.at(0), HasSubstr("nothing to compare"));
}

TEST(Expectation, OnlyWhatFallsShortIsAShortfall) {
  StudyResults results = eight_runs();
  results.expect = {expectation("{figure: rpe_1m_at_poses_translation, below: 100}"),
                    expectation("{finding: f, figure: rpe_1m_at_poses_translation, below: 1}"),
                    expectation("{figure: kitti_translation, below: 1}")};
  const std::vector<Judgement> found = shortfalls(results);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].expectation.finding, "f");
  EXPECT_EQ(found[0].variant, "indoor");
}

TEST(Expectation, IsRefusedWhereItIsIncompleteOrNamesWhatDoesNotExist) {
  const CellFilter names{{"room", "cave"}, {"dear", "cheap"}, {"good", "bad"}};
  const auto refusal = [&](const std::string& yaml) {
    try {
      check(expectation(yaml), names, "study");
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  const std::string rpe = "{figure: rpe_1m_at_poses_translation, ";
  EXPECT_EQ(refusal(rpe + "below: 1}"), "accepted");
  EXPECT_THAT(refusal("{figure: rpe_1m_at_pose_translation, below: 1}"), HasSubstr("did you mean"));
  EXPECT_THAT(refusal(rpe + "where: {world: [room]}}"), HasSubstr("says nothing of the figure"));
  EXPECT_THAT(refusal(rpe + "lowest: {algorithm: god}}"), HasSubstr("did you mean 'good'?"));
  EXPECT_THAT(refusal(rpe + "lowest: {algorithm: good, world: cave}}"), HasSubstr("exactly one"));
  EXPECT_THAT(refusal(rpe + "lowest: {}}"), HasSubstr("exactly one"));
  EXPECT_THAT(refusal(rpe + "below: 1, where: {sensor: [chaep]}}"), HasSubstr("no sensor 'chaep'"));
  EXPECT_THAT(refusal(rpe + "below: 1, ratio: {of: {world: cave}, to: {sensor: dear}}}"),
              HasSubstr("two different kinds"));
}

TEST(ReferenceFigures, AreFoundByTheirNamesAndEmptyNamesStandForAll) {
  StudyResults results;
  results.reference = {{"cave", "dear", "good", "rpe_1m_at_poses_translation", 1.5},
                       {"", "dear", "", "sensor_max_range_m", 100.0}};
  EXPECT_EQ(reference_of(results, "cave", "dear", "good", "rpe_1m_at_poses_translation"), 1.5);
  EXPECT_FALSE(reference_of(results, "room", "dear", "good", "rpe_1m_at_poses_translation"));
  EXPECT_EQ(reference_of(results, "", "dear", "", "sensor_max_range_m"), 100.0);
}

}  // namespace
}  // namespace lidarena::results
