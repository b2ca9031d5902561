// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/changes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/results/made_up_runs.hpp"

namespace lidarena::results {
namespace {

const std::array kOnlyDrift{&kDrift};

void add(StudyResults& results, const std::string& sensor, const std::vector<std::string>& differs,
         std::uint64_t seed, double drift) {
  RunRecord run = made_up::run_of("house", sensor, "arena_lio", drift, 1.0, seed);
  run.differs = differs;
  for (const std::string& name : differs)
    run.variation += (run.variation.empty() ? "" : " + ") + name;
  results.rows.push_back(run);
}

TEST(Changes, AreMediansOfDifferencesOnTheSameSeeds) {
  StudyResults results;
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U}) {
    const auto level = static_cast<double>(10 * seed);  // the seeds differ more than the settings
    add(results, "mid360", {}, seed, level);
    add(results, "mid360", {"shots"}, seed, level - 1.0 - 0.1 * static_cast<double>(seed));
    add(results, "mid360", {"range"}, seed, level + 0.5);
    add(results, "mid360", {"shots", "range"}, seed, level - 5.0);
    add(results, "os0", {}, seed, 2.0 * level);
    add(results, "os0", {"range"}, seed, 2.0 * level);
  }
  const std::vector<Change> changes = changes_of(results, kOnlyDrift);
  ASSERT_EQ(changes.size(), 3U) << "two settings at once are no single change";
  EXPECT_EQ(changes[0].variation, "shots");
  EXPECT_EQ(changes[0].sensor, "mid360");
  EXPECT_EQ(changes[0].method, "arena_lio (indoor)");
  EXPECT_EQ(changes[0].paired.pairs, 5U);
  EXPECT_NEAR(changes[0].paired.median_difference, -1.3, 1e-9);
  EXPECT_NEAR(changes[1].paired.median_difference, 0.5, 1e-9);
  EXPECT_EQ(changes[2].sensor, "os0");
  EXPECT_NEAR(changes[2].paired.median_difference, 0.0, 1e-9);
}

TEST(Changes, ALostRunIsWorseThanAnyOtherAndWhatHasNoPairIsLeftOut) {
  StudyResults results;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    add(results, "mid360", {}, seed, 1.0);
    add(results, "mid360", {"fast"}, seed, 1.0);
    if (seed != 3) made_up::lose(results.rows.back());
    add(results, "mid360", {"other seeds"}, seed + 10, 1.0);
  }
  const std::vector<Change> changes = changes_of(results, kOnlyDrift);
  ASSERT_EQ(changes.size(), 1U);
  EXPECT_EQ(changes[0].variation, "fast");
  EXPECT_EQ(changes[0].paired.median_difference, INFINITY);
}

}  // namespace
}  // namespace lidarena::results
