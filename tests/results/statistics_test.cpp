// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/statistics.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

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

constexpr double kLost = std::numeric_limits<double>::infinity();

TEST(Spread, MedianAndRangeAreKnown) {
  const Spread five = spread_of(flights_of({5.0, 1.0, 9.0, 2.0, 3.0}));
  EXPECT_EQ(five.median, 3.0);
  EXPECT_FALSE(five.median_95) << "the range of five holds the true median in 94 % only";
  const Spread spread = spread_of(flights_of({5.0, 1.0, 9.0, 2.0, 3.0, 3.0, 3.0}));
  EXPECT_EQ(spread.runs, 7U);
  EXPECT_EQ(spread.kept, 7U);
  EXPECT_EQ(spread.flights, 7U);
  EXPECT_EQ(spread.median, 3.0);
  EXPECT_EQ(spread.best, 1.0);
  EXPECT_EQ(spread.worst, 9.0);
  ASSERT_TRUE(spread.median_95);
  EXPECT_GE(spread.median_95->low, 1.0);
  EXPECT_LE(spread.median_95->high, 9.0);
}

TEST(Spread, ALostRunIsNamedAndTheWorstOfItsCell) {
  std::vector<RunFigure> runs = flights_of({1.0, 2.0, 3.0});
  runs.push_back({"flight3", "7", kLost, "diverged: 1e+06 m from the truth"});
  runs.push_back({"flight4", "1", kLost, "lost: it drifts by 200 cm per m"});
  const Spread spread = spread_of(runs);
  EXPECT_EQ(spread.runs, 5U);
  EXPECT_EQ(spread.kept, 3U);
  EXPECT_EQ(spread.median, 3.0) << "of 1 2 3 and two lost ones";
  EXPECT_EQ(spread.best, 1.0);
  EXPECT_EQ(spread.worst, kLost);
  EXPECT_FALSE(spread.is_lost());
  std::vector<RunFigure> six = runs;
  six.push_back({"flight6", "1", 2.5, ""});
  EXPECT_EQ(spread_of(six).median_95->high, kLost);
  EXPECT_THAT(spread.failures, ElementsAre("flight3 7: diverged: 1e+06 m from the truth",
                                           "flight4 1: lost: it drifts by 200 cm per m"));
  runs.push_back({"flight5", "1", kLost, "timeout"});
  EXPECT_TRUE(spread_of(runs).is_lost()) << "half of the runs: the upper of the middle two is lost";
  EXPECT_EQ(spread_of(runs).best, 1.0);
}

TEST(Spread, WhereMoreIsBetterALostRunIsBelowAll) {
  std::vector<RunFigure> runs = flights_of({1.0, 2.0, 3.0});
  runs.push_back({"flight3", "7", -kLost, "diverged"});
  runs.push_back({"flight4", "1", -kLost, "diverged"});
  const Spread spread = spread_of(runs, Better::kMore);
  EXPECT_EQ(spread.median, 1.0);
  EXPECT_EQ(spread.best, 3.0);
  EXPECT_EQ(spread.worst, -kLost);
  runs.push_back({"flight5", "1", -kLost, "diverged"});
  EXPECT_EQ(spread_of(runs, Better::kMore).median, -kLost);
}

TEST(Spread, AFigureThatNoKeptRunHasIsNotCalledLost) {
  const std::vector<RunFigure> runs{{"a", "1", std::nullopt, ""}, {"b", "1", kLost, "diverged"}};
  EXPECT_FALSE(spread_of(runs).median) << "100 m of KITTI's error in a short flight";
  EXPECT_EQ(spread_of(runs).kept, 1U);
  EXPECT_TRUE(spread_of(std::vector<RunFigure>{{"f", "1", kLost, "crashed"}}).is_lost());
  EXPECT_FALSE(spread_of(std::vector<RunFigure>{}).median);
}

TEST(Bootstrap, OfEqualValuesIsThatValueAndOfFiveFlightsIsNone) {
  const auto equal = spread_of(flights_of({2.5, 2.5, 2.5, 2.5, 2.5, 2.5})).median_95;
  ASSERT_TRUE(equal);
  EXPECT_EQ(equal->low, 2.5);
  EXPECT_EQ(equal->high, 2.5);
  EXPECT_FALSE(spread_of(flights_of({1.0, 2.0, 3.0, 4.0, 5.0})).median_95);
}

TEST(Bootstrap, OfSixFlightsReachesFromTheLowestToTheHighestButForTheLastStep) {
  // Of a resample of six, four or more are the lowest with a probability of 0.9 %, three or more
  // with 6 %: the median of 2.5 % is the mean of the lowest and one of the others.
  const auto interval = spread_of(flights_of({1.0, 2.0, 4.0, 8.0, 16.0, 32.0})).median_95;
  ASSERT_TRUE(interval);
  EXPECT_GE(interval->low, 1.0);
  EXPECT_LE(interval->low, 1.5);
  EXPECT_GE(interval->high, 24.0);
  EXPECT_LE(interval->high, 32.0);
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
  const Spread a = spread_of(runs, Better::kLess, 4);
  std::reverse(runs.begin(), runs.end());
  const Spread b = spread_of(runs, Better::kLess, 4);
  EXPECT_EQ(a.median_95->low, b.median_95->low);
  EXPECT_EQ(a.median_95->high, b.median_95->high);
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
    const auto interval = spread_of(flights_of(values), Better::kLess, 1, 400).median_95;
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

TEST(Wilcoxon, AgreesWithScipy) {
  // scipy 1.10.1: wilcoxon([((i*37)%53-20.3)/10 for i in range(n)], mode="exact"), n = 20 and 50
  std::vector<double> d;
  for (int i = 0; i < 50; ++i) d.push_back((i * 37 % 53 - 20.3) / 10);
  EXPECT_NEAR(*wilcoxon_signed_rank_p(std::span(d).first(20)), 0.17685317993164062, 1e-14);
  EXPECT_NEAR(*wilcoxon_signed_rank_p(d), 0.025500083179634814, 1e-14);
  // wilcoxon([float((i*37)%53%17-6) for i in range(120)], mode="approx", correction=True): six
  // zeros and many ties
  d.clear();
  for (int i = 0; i < 120; ++i) d.push_back(i * 37 % 53 % 17 - 6);
  EXPECT_NEAR(*wilcoxon_signed_rank_p(d), 0.0016135375151693054, 1e-14);
}

TEST(Wilcoxon, HasTheTabulatedCriticalValues) {
  // Critical values of the smaller rank sum at 5 % (two-sided), as printed in every table: 29 for
  // 16 differences, 52 for 20, 89 for 25. The sum that is larger by one does not pass.
  for (const auto& [n, critical] : {std::pair{16, 29}, {20, 52}, {25, 89}}) {
    for (const int sum : {critical, critical + 1}) {
      std::vector<double> d;  // ranks 1..n; negative ones, the largest that fit first, sum to `sum`
      int left = sum;
      for (int rank = n; rank >= 1; --rank) {
        d.push_back(rank <= left ? -rank : rank);
        if (rank <= left) left -= rank;
      }
      EXPECT_EQ(*wilcoxon_signed_rank_p(d) <= 0.05, sum == critical) << n << " " << sum;
    }
  }
}

TEST(Wilcoxon, TheNormalApproximationMeetsTheExactCountWhereItTakesOver) {
  SequentialRandom random(14);
  std::vector<double> differences;
  for (int i = 0; i < 51; ++i) differences.push_back(random.normal() + 0.15);
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
                                 {"mine", "1", std::nullopt, ""},
                                 {"yard", "1", 1.0, ""}};
  const PairedComparison found = compare_paired(a, b);
  EXPECT_EQ(found.pairs, 3U);
  EXPECT_EQ(found.b_smaller, 2U);
  EXPECT_EQ(found.a_smaller, 0U);
  EXPECT_EQ(found.ties, 1U);
  EXPECT_DOUBLE_EQ(found.median_difference, -0.5);
  EXPECT_THAT(found.missing, ElementsAre("mine 1: b: has no such figure", "tube 1: b: was not run",
                                         "yard 1: a: was not run"));
  EXPECT_DOUBLE_EQ(*found.wilcoxon_p, 0.5);       // two differences of one sign
  EXPECT_FALSE(found.difference_95.has_value());  // of two flights
}

TEST(PairedComparison, ALostRunIsTheWorseOneOfItsPairAndTwoLostOnesAreNoPair) {
  const std::vector<RunFigure> a{{"f", "1", 1.0, ""},
                                 {"f", "2", kLost, "diverged"},
                                 {"f", "3", kLost, "diverged"},
                                 {"f", "4", 2.0, ""}};
  const std::vector<RunFigure> b{{"f", "1", 1.5, ""},
                                 {"f", "2", kLost, "diverged"},
                                 {"f", "3", 9.0, ""},
                                 {"f", "4", kLost, "diverged"}};
  const PairedComparison found = compare_paired(a, b);
  EXPECT_EQ(found.pairs, 3U);
  EXPECT_EQ(found.ties, 0U);
  EXPECT_EQ(found.b_smaller, 1U);
  EXPECT_EQ(found.a_smaller, 2U);
  EXPECT_EQ(found.median_difference, 0.5) << "of -inf, 0.5, inf";
  EXPECT_THAT(found.missing, ElementsAre("f 2: lost with both"));
}

TEST(Holm, AgreesWithAnExampleByHand) {
  // 0.01 * 4, 0.02 * 3, 0.03 * 2 (raised to the one before it), 0.5 * 1
  const std::vector<double> corrected = holm(std::vector<double>{0.03, 0.01, 0.5, 0.02});
  EXPECT_NEAR(corrected[1], 0.04, 1e-15);
  EXPECT_NEAR(corrected[3], 0.06, 1e-15);
  EXPECT_NEAR(corrected[0], 0.06, 1e-15);
  EXPECT_NEAR(corrected[2], 0.5, 1e-15);
  EXPECT_TRUE(holm(std::vector<double>{}).empty());
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
