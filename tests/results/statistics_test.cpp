// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/statistics.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lidarena/base/random.hpp"

namespace lidarena::results {
namespace {

using ::testing::ElementsAre;

/// One flight per value, named by its index.
std::vector<RunFigure> flights_of(const std::vector<double>& values) {
  std::vector<RunFigure> runs;
  for (std::size_t i = 0; i < values.size(); ++i) {
    runs.push_back({"flight" + std::to_string(i), "1", values[i], ""});
  }
  return runs;
}

TEST(Spread, MedianAndRangeOfFiveRunsAreKnown) {
  const Spread spread = spread_of(flights_of({5.0, 1.0, 9.0, 2.0, 3.0}));
  EXPECT_EQ(spread.runs, 5U);
  EXPECT_EQ(spread.values, 5U);
  EXPECT_EQ(spread.flights, 5U);
  EXPECT_EQ(spread.median, 3.0);
  EXPECT_EQ(spread.min, 1.0);
  EXPECT_EQ(spread.max, 9.0);
  EXPECT_DOUBLE_EQ(spread.mean, 4.0);
  EXPECT_EQ(spread.median_with_failures, 3.0);
  ASSERT_TRUE(spread.median_95);
  EXPECT_GE(spread.median_95->low, 1.0);
  EXPECT_LE(spread.median_95->high, 9.0);
}

TEST(Spread, AFailureIsNamedAndCountsAsWorstNotAsAbsent) {
  std::vector<RunFigure> runs = flights_of({1.0, 2.0, 3.0});
  runs.push_back({"flight3", "7", std::nullopt, "diverged: 1e+06 m from the truth"});
  runs.push_back({"flight4", "1", std::nullopt, ""});
  Spread spread = spread_of(runs);
  EXPECT_EQ(spread.runs, 5U);
  EXPECT_EQ(spread.values, 3U);
  EXPECT_EQ(spread.median, 2.0);
  EXPECT_EQ(spread.median_with_failures, 3.0);                                 // of 1 2 3 inf inf
  EXPECT_EQ(spread_of(runs, 1, 10, Better::kMore).median_with_failures, 1.0);  // -inf -inf 1 2 3
  EXPECT_THAT(spread.failures, ElementsAre("flight3 7: diverged: 1e+06 m from the truth",
                                           "flight4 1: has no such figure"));
  runs.push_back({"flight5", "1", std::nullopt, "timeout"});
  EXPECT_FALSE(spread_of(runs).median_with_failures.has_value());  // of 1 2 3 inf inf inf
  const Spread none = spread_of(std::vector<RunFigure>{{"f", "1", std::nullopt, "crashed"}});
  EXPECT_EQ(none.values, 0U);
  EXPECT_FALSE(none.median_95.has_value());
}

TEST(Bootstrap, OfEqualValuesIsThatValueAndOfTwoFlightsIsNone) {
  const auto equal = spread_of(flights_of({2.5, 2.5, 2.5, 2.5})).median_95;
  ASSERT_TRUE(equal);
  EXPECT_EQ(equal->low, 2.5);
  EXPECT_EQ(equal->high, 2.5);
  EXPECT_FALSE(spread_of(flights_of({1.0, 2.0})).median_95.has_value());
}

TEST(Bootstrap, OfThreeFlightsIsTheRange) {
  // the minimum of three is the median of a resample with probability 7/27, far above 2.5 %
  const auto interval = spread_of(flights_of({1.0, 2.0, 4.0})).median_95;
  ASSERT_TRUE(interval);
  EXPECT_EQ(interval->low, 1.0);
  EXPECT_EQ(interval->high, 4.0);
}

TEST(Bootstrap, IsOverFlightsSoThatMoreSeedsOfTheSameFlightsDoNotNarrowIt) {
  std::vector<double> values;
  SequentialRandom random(8);
  for (int i = 0; i < 12; ++i) values.push_back(random.normal());
  const std::vector<RunFigure> once = flights_of(values);
  std::vector<RunFigure> thrice;
  for (const char* seed : {"1", "2", "3"}) {
    for (RunFigure run : once) {
      run.seed = seed;
      thrice.push_back(run);
    }
  }
  const Spread a = spread_of(once);
  const Spread b = spread_of(thrice);
  EXPECT_EQ(b.runs, 36U);
  EXPECT_EQ(b.flights, 12U);
  EXPECT_EQ(a.median_95->low, b.median_95->low);
  EXPECT_EQ(a.median_95->high, b.median_95->high);
}

TEST(Bootstrap, IsTheSameBitsForTheSameSeedInWhateverOrderTheRunsCome) {
  std::vector<double> values;
  SequentialRandom random(9);
  for (int i = 0; i < 9; ++i) values.push_back(random.normal());
  std::vector<RunFigure> runs = flights_of(values);
  const Spread a = spread_of(runs, 4);
  std::reverse(runs.begin(), runs.end());
  const Spread b = spread_of(runs, 4);
  EXPECT_EQ(a.median_95->low, b.median_95->low);
  EXPECT_EQ(a.median_95->high, b.median_95->high);
  EXPECT_EQ(a.mean, b.mean);
}

TEST(Bootstrap, CoversTheTrueMedianAboutAsOftenAsItSays) {
  // Percentile intervals of a median are slightly inaccurate for 25 samples (they jump between
  // order statistics), hence 91 .. 99 %; 400 trials have a standard deviation of 1.1 %.
  SequentialRandom random(10);
  int covered = 0;
  constexpr int kTrials = 400;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<double> values;
    for (int i = 0; i < 25; ++i) values.push_back(std::exp(random.normal()));  // true median 1
    const auto interval = spread_of(flights_of(values), 1, 400).median_95;
    if (interval->low <= 1.0 && 1.0 <= interval->high) ++covered;
  }
  EXPECT_GT(covered, 0.91 * kTrials);
  EXPECT_LT(covered, 0.99 * kTrials);
}

TEST(Wilcoxon, AllDifferencesOfOneSignHaveTheKnownProbability) {
  const std::vector<double> positive{0.5, 1.1, 2.0, 3.7, 4.1, 9.0};
  for (std::size_t n = 1; n <= positive.size(); ++n) {
    const auto p = wilcoxon_signed_rank_p(std::span(positive).first(n));
    EXPECT_DOUBLE_EQ(*p, std::min(1.0, 2.0 / std::pow(2.0, static_cast<double>(n))));
  }
}

TEST(Wilcoxon, AgreesWithTheTextbookExample) {
  // Hollander, Wolfe, "Nonparametric statistical methods", table 3.1 (depression scale, 9
  // patients): V = 40, one-sided p = 0.01953 = 10/512
  const std::vector<double> before{1.83, 0.50, 1.62, 2.48, 1.68, 1.88, 1.55, 3.06, 1.30};
  const std::vector<double> after{0.878, 0.647, 0.598, 2.05, 1.06, 1.29, 1.06, 3.14, 1.29};
  std::vector<double> differences;
  for (std::size_t i = 0; i < before.size(); ++i) differences.push_back(before[i] - after[i]);
  EXPECT_NEAR(*wilcoxon_signed_rank_p(differences), 20.0 / 512.0, 1e-15);
  for (double& d : differences) d = -d;
  EXPECT_NEAR(*wilcoxon_signed_rank_p(differences), 20.0 / 512.0, 1e-15);
}

/// The p value by enumerating all combinations of signs.
double slow_p(const std::vector<double>& magnitudes, std::size_t observed_signs) {
  const auto sum_of = [&](std::size_t signs) {
    double sum = 0.0;
    for (std::size_t i = 0; i < magnitudes.size(); ++i) {
      if ((signs >> i & 1) == 0) continue;
      double rank = 0.5;  // mean rank: those below, and half of the equal ones and itself
      for (const double other : magnitudes) {
        rank += other < magnitudes[i] ? 1.0 : other == magnitudes[i] ? 0.5 : 0.0;
      }
      sum += rank;
    }
    return sum;
  };
  const double seen = sum_of(observed_signs);
  double below = 0.0;
  double above = 0.0;
  const std::size_t all = std::size_t{1} << magnitudes.size();
  for (std::size_t signs = 0; signs < all; ++signs) {
    if (sum_of(signs) <= seen) below += 1.0;
    if (sum_of(signs) >= seen) above += 1.0;
  }
  return std::min(1.0, 2.0 * std::min(below, above) / static_cast<double>(all));
}

TEST(Wilcoxon, AgreesWithCountingAllSignsAlsoWithTiesAndZeros) {
  SequentialRandom random(13);
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<double> magnitudes;
    std::vector<double> differences{0.0, 0.0};
    std::size_t signs = 0;
    for (std::size_t i = 0; i < 9; ++i) {
      magnitudes.push_back(random.integer(1, 5));  // many ties
      const bool positive = random.uniform() < 0.7;
      if (positive) signs |= std::size_t{1} << i;
      differences.push_back(positive ? magnitudes[i] : -magnitudes[i]);
    }
    EXPECT_NEAR(*wilcoxon_signed_rank_p(differences), slow_p(magnitudes, signs), 1e-12);
  }
  EXPECT_FALSE(wilcoxon_signed_rank_p(std::vector<double>{0.0, 0.0}).has_value());
}

TEST(Wilcoxon, TheNormalApproximationMeetsTheExactCountWhereItTakesOver) {
  SequentialRandom random(14);
  std::vector<double> differences;
  for (int i = 0; i < 201; ++i) differences.push_back(random.normal() + 0.15);
  const double beyond = *wilcoxon_signed_rank_p(differences);
  differences.pop_back();
  const double exact = *wilcoxon_signed_rank_p(differences);
  EXPECT_NEAR(beyond, exact, 0.1 * exact + 0.002);
}

TEST(PairedComparison, ComparesTheSameFlightsAndSeedsAndNamesWhatIsMissing) {
  const std::vector<RunFigure> a{{"house", "1", 2.0, ""},
                                 {"house", "2", 2.5, ""},
                                 {"cave", "1", 4.0, ""},
                                 {"mine", "1", 3.0, ""},
                                 {"tube", "1", 1.0, ""}};
  const std::vector<RunFigure> b{{"cave", "1", 3.0, ""},
                                 {"house", "1", 1.5, ""},
                                 {"house", "2", 2.5, ""},
                                 {"mine", "1", std::nullopt, "diverged"},
                                 {"yard", "1", 1.0, ""}};
  const PairedComparison found = compare_paired(a, b);
  EXPECT_EQ(found.pairs, 3U);
  EXPECT_EQ(found.b_smaller, 2U);
  EXPECT_EQ(found.a_smaller, 0U);
  EXPECT_EQ(found.ties, 1U);
  EXPECT_DOUBLE_EQ(found.median_difference, -0.5);
  EXPECT_THAT(found.missing, ElementsAre("mine 1: b: diverged", "tube 1: b: was not run",
                                         "yard 1: a: was not run"));
  EXPECT_DOUBLE_EQ(*found.wilcoxon_p, 0.5);       // two differences of one sign
  EXPECT_FALSE(found.difference_95.has_value());  // of two flights
}

TEST(PairedComparison, SeesASmallConstantGainBelowTheSpreadOfTheFlights) {
  SequentialRandom random(15);
  std::vector<double> before;
  std::vector<double> after;
  for (int i = 0; i < 12; ++i) {
    before.push_back(10.0 + 5.0 * random.uniform());
    after.push_back(before.back() - 0.1 + 0.02 * random.normal());
  }
  const PairedComparison found = compare_paired(flights_of(before), flights_of(after));
  EXPECT_LT(found.difference_95->high, 0.0);
  EXPECT_NEAR(found.median_difference, -0.1, 0.02);
  EXPECT_LT(*found.wilcoxon_p, 0.001);
  // unpaired, the intervals overlap
  const Interval a = *spread_of(flights_of(before)).median_95;
  const Interval b = *spread_of(flights_of(after)).median_95;
  EXPECT_LT(a.low, b.high);
}

}  // namespace
}  // namespace lidarena::results
