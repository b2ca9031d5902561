// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/version_comparison.hpp"

#include <gmock/gmock.h>

#include "made_up_runs.hpp"

namespace lidarena::results {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Eight seeds of one method on two sensors; `factor` scales the drift of the second sensor.
StudyResults eight_seeds(double factor, const std::string& method = "kiss_icp") {
  StudyResults study;
  study.title = "eight seeds";
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const double drift = 1.0 + 0.1 * static_cast<double>(seed);
    study.rows.push_back(made_up::run_of("cave", "mid360", method, drift, 0.0, seed));
    study.rows.push_back(made_up::run_of("cave", "os0", method, factor * drift, 0.0, seed));
  }
  return study;
}

const FigureChange& change_of(const VersionComparison& comparison, const std::string& sensor,
                              const Figure& figure) {
  for (const FigureChange& change : comparison.changes)
    if (change.sensor == sensor && change.figure == &figure) return change;
  throw std::runtime_error("no such change");
}

TEST(CompareVersions, WhatGotWorseOnEveryPairIsWorseAndStandsFirst) {
  const VersionComparison found = compare_versions(eight_seeds(1.0), eight_seeds(1.2));
  const FigureChange& drift = change_of(found, "os0", kDrift);
  EXPECT_EQ(drift.verdict, Verdict::kWorse);
  EXPECT_NEAR(drift.before, 1.45, 1e-9);
  EXPECT_NEAR(*drift.worsening_percent(), 20.0, 1e-9);
  EXPECT_EQ(drift.paired.pairs, 8U);
  EXPECT_NEAR(*drift.ratios.ratio, 1.2, 1e-12);
  EXPECT_NEAR(to_json(found).at("changes").at(0).at("ratio_95").at(0), 1.2, 1e-12);
  // Eight differences of one sign: 2 / 2^8. Of the figures here two differ (drift and map), so Holm
  // doubles the smaller of two equal ones and keeps the other at that.
  EXPECT_NEAR(*drift.p, 2.0 * 2.0 / 256.0, 1e-12);
  EXPECT_EQ(change_of(found, "mid360", kDrift).verdict, Verdict::kNeither);
  EXPECT_FALSE(change_of(found, "mid360", kDrift).p) << "all pairs are ties";
  EXPECT_EQ(found.changes.front().sensor, "os0");
  const VersionComparison back = compare_versions(eight_seeds(1.2), eight_seeds(1.0));
  EXPECT_EQ(change_of(back, "os0", kDrift).verdict, Verdict::kBetter);
}

TEST(CompareVersions, FivePairsAreTooFewForAVerdict) {
  StudyResults before = eight_seeds(1.0), after = eight_seeds(2.0);
  before.rows.resize(10);
  const VersionComparison found = compare_versions(before, after);
  EXPECT_EQ(change_of(found, "os0", kDrift).paired.pairs, 5U);
  EXPECT_EQ(change_of(found, "os0", kDrift).verdict, Verdict::kNeither);
  EXPECT_EQ(found.unpaired, 6U);
  EXPECT_EQ(found.tests, 2U);
  EXPECT_EQ(found.pairs_needed(), 7U) << "2 / 2^7 * 2 = 0.03";
}

TEST(CompareVersions, LostRunsAreCountedAndNamedNotLeftOut) {
  StudyResults after = eight_seeds(1.0);
  after.rows[3].status = "diverged";
  after.rows[3].reason = "12 m from the truth";
  const VersionComparison found = compare_versions(eight_seeds(1.0), after);
  ASSERT_EQ(found.lost.size(), 2U);
  EXPECT_EQ(found.lost[1].after, 1U);
  EXPECT_EQ(found.lost[1].before, 0U);
  EXPECT_THAT(found.lost[1].newly, ElementsAre(HasSubstr("os0-kiss_icp-2: diverged: 12 m")));
  EXPECT_EQ(change_of(found, "os0", kDrift).paired.pairs, 8U);
  EXPECT_EQ(change_of(found, "os0", kDrift).paired.a_smaller, 1U)
      << "the lost run is the worse one";
  EXPECT_THAT(comparison_text(found), HasSubstr("os0 with kiss_icp (indoor): 1 of 8 runs lost"));
}

TEST(CompareVersions, AMethodThatLosesRunsIsWorseThoughTheOthersGotBetter) {
  StudyResults after = eight_seeds(0.99);
  for (std::size_t i = 1; i < after.rows.size(); i += 2) made_up::lose(after.rows[i]);  // all os0
  const VersionComparison found = compare_versions(eight_seeds(1.0), after);
  const FigureChange& drift = change_of(found, "os0", kDrift);
  EXPECT_EQ(drift.verdict, Verdict::kWorse);
  EXPECT_FALSE(drift.worsening_percent());
  EXPECT_EQ(to_json(found).at("changes").at(0).at("after"), "lost");
  EXPECT_EQ(exceeded(found, {parse_limit("drift=500%")}).size(), 1U);
  const VersionComparison both = compare_versions(after, after);
  EXPECT_TRUE(exceeded(both, {parse_limit("drift=0%"), parse_limit("lost=0")}).empty());
}

TEST(CompareVersions, StudiesOfOneMethodAreComparedWhateverItIsCalled) {
  const VersionComparison found =
      compare_versions(eight_seeds(1.0, "mine_v1"), eight_seeds(0.5, "mine_v2"));
  EXPECT_EQ(change_of(found, "os0", kDrift).method, "mine_v2 (indoor)");
  EXPECT_EQ(change_of(found, "os0", kDrift).verdict, Verdict::kBetter);
  StudyResults other = eight_seeds(1.0);
  for (RunRecord& run : other.rows) run.world = "house";
  EXPECT_THROW(compare_versions(eight_seeds(1.0), other), InputError);
}

std::vector<std::string> beyond(const VersionComparison& comparison, const std::string& limit) {
  return exceeded(comparison, {parse_limit(limit)});
}

TEST(FailOn, ALimitIsOnTheGrowthOfTheMedianInPercentOrInTheUnit) {
  const VersionComparison worse = compare_versions(eight_seeds(1.0), eight_seeds(1.2));
  EXPECT_THAT(beyond(worse, "drift=19%"), ElementsAre(HasSubstr("os0 with kiss_icp (indoor)")));
  EXPECT_TRUE(beyond(worse, "drift=21%").empty());
  EXPECT_EQ(beyond(worse, "drift=0.28").size(), 1U) << "1.45 -> 1.74 cm";
  EXPECT_TRUE(beyond(worse, "drift=0.30").empty());
  EXPECT_EQ(beyond(worse, "own_map_rmse=5%").size(), 1U);
  EXPECT_TRUE(beyond(worse, "lost=0").empty());
  EXPECT_TRUE(beyond(compare_versions(eight_seeds(1.2), eight_seeds(1.0)), "drift=0%").empty());
  StudyResults lost = eight_seeds(1.0);
  lost.rows[0].status = "failed";
  EXPECT_EQ(beyond(compare_versions(eight_seeds(1.0), lost), "lost=0").size(), 1U);
  EXPECT_TRUE(beyond(compare_versions(eight_seeds(1.0), lost), "lost=1").empty());
}

TEST(FailOn, WhatIsNotALimitIsRefused) {
  for (const char* text : {"drift", "drift=", "drift=-1", "drift=5%%", "speed=1", "lost=5%",
                           "latency_max=1", "drift=nan", "latency=5%"}) {
    EXPECT_THROW(parse_limit(text), InputError) << text;
  }
}

}  // namespace
}  // namespace lidarena::results
