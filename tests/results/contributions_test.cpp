// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/contributions.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "lidarena/base/random.hpp"
#include "tests/results/made_up_runs.hpp"

namespace lidarena::results {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// By definition: what each part changes, over all orders of changing them.
std::vector<double> over_all_orders(const std::vector<double>& worth, std::size_t parts) {
  std::vector<std::size_t> order(parts);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::vector<double> sums(parts);
  double orders = 0.0;
  do {
    std::size_t changed = 0;
    for (const std::size_t part : order) {
      const std::size_t next = changed | std::size_t{1} << part;
      sums[part] += worth[next] - worth[changed];
      changed = next;
    }
    orders += 1.0;
  } while (std::next_permutation(order.begin(), order.end()));
  for (double& sum : sums) sum /= orders;
  return sums;
}

TEST(ShapleyValues, AreTheMeanOverAllOrdersAndAddUpToTheDifference) {
  SequentialRandom random(3);
  for (std::size_t parts = 1; parts <= 6; ++parts) {
    std::vector<double> worth(std::size_t{1} << parts);
    for (double& value : worth) value = random.uniform(-2.0, 5.0);
    const std::vector<double> exact = shapley_values(worth), slow = over_all_orders(worth, parts);
    ASSERT_EQ(exact.size(), parts);
    for (std::size_t i = 0; i < parts; ++i) EXPECT_NEAR(exact[i], slow[i], 1e-12);
    EXPECT_NEAR(std::accumulate(exact.begin(), exact.end(), 0.0), worth.back() - worth.front(),
                1e-12);
  }
}

/// Drift of a combination: the first part lowers it by 2, the second by 1 if the first is there,
/// the third does nothing.
double drift_of(std::size_t combination, std::uint64_t seed) {
  const double both = (combination & 3U) == 3U ? 1.0 : 0.0;
  return 10.0 - 2.0 * static_cast<double>(combination & 1U) - both +
         0.01 * static_cast<double>(seed);
}

StudyResults all_combinations(std::uint64_t seeds) {
  const std::vector<std::string> names{"field", "shots", "paint"};
  StudyResults results;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    for (std::size_t c = 0; c < 8; ++c) {
      RunRecord run = made_up::run_of("house", "mid360", "arena_lio", drift_of(c, seed), 1.0, seed);
      for (std::size_t i = 0; i < 3; ++i) {
        if ((c >> i & 1U) == 0) continue;
        run.differs.push_back(names[i]);
        run.variation += (run.variation.empty() ? "" : " + ") + names[i];
      }
      run.name += run.variation;
      results.rows.push_back(run);
    }
  }
  return results;
}

const std::array kDriftAlone{&kDrift};

TEST(Contributions, ShareAnInteractionBetweenItsParts) {
  const auto found = contributions_of(all_combinations(7), kDriftAlone);
  ASSERT_EQ(found.size(), 1U);
  const Contributions& house = found.front();
  EXPECT_EQ(house.world, "house");
  EXPECT_EQ(house.missing, "");
  EXPECT_EQ(house.flights, 7U);
  EXPECT_NEAR(house.base, 10.04, 1e-9);
  EXPECT_NEAR(house.all, 7.04, 1e-9);
  ASSERT_EQ(house.parts.size(), 3U);
  EXPECT_EQ(house.parts[0].name, "field");
  EXPECT_NEAR(house.parts[0].value, -2.5, 1e-9);
  EXPECT_NEAR(house.parts[1].value, -0.5, 1e-9);
  EXPECT_NEAR(house.parts[2].value, 0.0, 1e-9);
  for (const Contribution& part : house.parts) {  // the seeds differ, their differences do not
    ASSERT_TRUE(part.value_95);
    EXPECT_NEAR(part.value_95->low, part.value, 1e-9);
    EXPECT_NEAR(part.value_95->high, part.value, 1e-9);
  }
}

TEST(Contributions, HaveAnIntervalThatGrowsWithTheSpreadOverSeeds) {
  StudyResults results = all_combinations(8);
  for (RunRecord& run : results.rows) {
    if (run.differs.empty() || run.differs.front() != "field") continue;
    const double more = run.seed % 2 == 0 ? 0.6 : -0.6;  // the gain of the field varies by seed
    set_metrics(run, made_up::metrics_of(*value_of(run, kDrift) + more, 1.0));
  }
  const Contributions found = contributions_of(results, kDriftAlone).front();
  ASSERT_TRUE(found.parts[0].value_95);
  EXPECT_LT(found.parts[0].value_95->low, found.parts[0].value - 0.3);
  EXPECT_GT(found.parts[0].value_95->high, found.parts[0].value + 0.3);
  EXPECT_NEAR(found.parts[2].value_95->high, 0.0, 1e-9);
  std::reverse(results.rows.begin(), results.rows.end());
  const Contributions again = contributions_of(results, kDriftAlone).front();
  const auto field = std::ranges::find(again.parts, "field", &Contribution::name);
  EXPECT_EQ(field->value_95->low, found.parts[0].value_95->low) << "whatever the order of the runs";
}

TEST(Contributions, AreNotGivenWhereHalfOfTheRunsOfACombinationAreLost) {
  StudyResults results = all_combinations(4);
  for (RunRecord& run : results.rows)
    if (run.variation == "shots + paint" && run.seed <= 2) made_up::lose(run);
  const auto found = contributions_of(results, kDriftAlone);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_THAT(found.front().missing, HasSubstr("lost with: shots + paint"));
  EXPECT_THAT(found.front().parts, IsEmpty());
  // Two lost runs of six leave a median, but no interval: they may be drawn more than twice.
  results = all_combinations(6);
  for (RunRecord& run : results.rows)
    if (run.variation == "shots + paint" && run.seed <= 2) made_up::lose(run);
  const Contributions kept = contributions_of(results, kDriftAlone).front();
  EXPECT_EQ(kept.parts.size(), 3U);
  EXPECT_FALSE(kept.parts[0].value_95);
}

TEST(Contributions, NeedAllCombinations) {
  StudyResults results = all_combinations(3);
  std::erase_if(results.rows,
                [](const RunRecord& run) { return run.variation == "field + shots"; });
  EXPECT_THAT(contributions_of(results, kDriftAlone), IsEmpty());
  results = all_combinations(3);
  for (RunRecord& run : results.rows)  // two values of one key are no combination of changes
    if (run.variation == "paint" && run.seed == 2) run.variation = "paint=2";
  EXPECT_THAT(contributions_of(results, kDriftAlone), IsEmpty());
}

}  // namespace
}  // namespace lidarena::results
