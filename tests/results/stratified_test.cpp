// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/stratified.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "lidarena/base/random.hpp"

namespace lidarena::results {
namespace {

using Strata = std::vector<std::vector<double>>;
constexpr double kInfinite = std::numeric_limits<double>::infinity();

std::vector<double> normals(SequentialRandom& random, std::size_t n, double mean) {
  std::vector<double> values;
  for (std::size_t i = 0; i < n; ++i) values.push_back(mean + random.normal());
  return values;
}

/// The sum over strata of the ranks of positive values over n + 1, written down anew.
double statistic(const Strata& strata) {
  double sum = 0.0;
  for (const std::vector<double>& d : strata) {
    for (const double x : d) {
      double rank = 0.5;
      for (const double y : d)
        rank += std::abs(y) < std::abs(x) ? 1.0 : std::abs(y) == std::abs(x) ? 0.5 : 0.0;
      if (x > 0.0) sum += rank / static_cast<double>(d.size() + 1);
    }
  }
  return sum;
}

/// Share of all combinations of signs whose statistic is as far on one side, doubled.
double p_by_enumeration(const Strata& strata) {
  std::size_t n = 0;
  for (const auto& stratum : strata) n += stratum.size();
  const double seen = statistic(strata);
  std::size_t below = 0, above = 0;
  for (std::size_t signs = 0; signs < (std::size_t{1} << n); ++signs) {
    Strata changed = strata;
    std::size_t bit = 0;
    for (auto& stratum : changed)
      for (double& x : stratum) x = ((signs >> bit++) & 1U) != 0 ? std::abs(x) : -std::abs(x);
    const double other = statistic(changed);
    below += other <= seen + 1e-9 ? 1 : 0;
    above += other >= seen - 1e-9 ? 1 : 0;
  }
  const double all = static_cast<double>(std::size_t{1} << n);
  return std::min(1.0, 2.0 * static_cast<double>(std::min(below, above)) / all);
}

TEST(Stratified, TheTestIsTheShareOfAllCombinationsOfSigns) {
  SequentialRandom random(3);
  for (int trial = 0; trial < 6; ++trial) {
    Strata strata{normals(random, 5, 0.5), normals(random, 6, 0.8)};
    if (trial % 2 == 1) strata[0][1] = -strata[0][0];  // shared ranks
    if (trial > 3) strata.push_back({0.4});
    EXPECT_NEAR(*compare_strata(strata).p, p_by_enumeration(strata), 1e-12);
  }
}

TEST(Stratified, OfOneStratumItIsWilcoxonsTest) {
  SequentialRandom random(4);
  for (const std::size_t n : {4U, 9U, 16U, 30U}) {
    const std::vector<double> d = normals(random, n, 0.3);
    EXPECT_NEAR(*compare_strata(Strata{d}).p, *wilcoxon_signed_rank_p(d), 1e-12);
  }
}

TEST(Stratified, WorldsOfOneSignEachOfEightHaveTheKnownProbability) {
  const std::vector<double> eight{0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8};
  const StratifiedComparison found = compare_strata(Strata{eight, eight});
  EXPECT_EQ(found.pairs, 16U);
  EXPECT_DOUBLE_EQ(*found.p, 2.0 / 65536.0);
  EXPECT_FALSE(found.b_is_smaller);
}

TEST(Stratified, AWorldOfLargeRatiosDoesNotOutvoteOneOfSmall) {
  // ten pairs for a in one world, ten for b in the other: no evidence, whatever their size
  std::vector<double> small, large;
  for (int i = 1; i <= 10; ++i) {
    small.push_back(0.01 * i);
    large.push_back(-1.0 * i);
  }
  EXPECT_GT(*compare_strata(Strata{small, large}).p, 0.9);
  std::vector<double> pooled = small;
  pooled.insert(pooled.end(), large.begin(), large.end());
  EXPECT_LT(*wilcoxon_signed_rank_p(pooled), 0.1) << "of pooled differences the large ones decide";
}

TEST(HodgesLehmann, IsTheMedianOfTheMeansOfPairs) {
  // of 1 2 6: the means 1, 1.5, 2, 3.5, 4, 6
  EXPECT_NEAR(*compare_strata(Strata{{1.0, 2.0, 6.0}}).ratio, std::exp(2.75), 1e-12);
  EXPECT_FALSE(compare_strata(Strata{{1.0, 2.0, 6.0}}).ratio_95) << "p of three is 1/4 at least";
}

TEST(HodgesLehmann, TheIntervalHasTheCriticalValuesOfTheTables) {
  // 2.5 % tables of the signed-rank test: 0 for six differences, 3 for eight, 8 for ten
  SequentialRandom random(5);
  for (const auto& [n, critical] : {std::pair<std::size_t, std::size_t>{6, 0}, {8, 3}, {10, 8}}) {
    const std::vector<double> d = normals(random, n, 0.2);
    std::vector<double> means;
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t k = i; k < n; ++k) means.push_back(0.5 * (d[i] + d[k]));
    std::ranges::sort(means);
    const auto interval = compare_strata(Strata{d}).ratio_95;
    ASSERT_TRUE(interval);
    EXPECT_NEAR(interval->low, std::exp(means[critical]), 1e-12);
    EXPECT_NEAR(interval->high, std::exp(means[means.size() - 1 - critical]), 1e-12);
  }
}

TEST(HodgesLehmann, ARatioThatIsTheSameInAllWorldsIsFoundAndCoveredAsOftenAsItSays) {
  SequentialRandom random(6);
  int covered = 0;
  constexpr int kTrials = 400;
  for (int trial = 0; trial < kTrials; ++trial) {
    Strata strata{normals(random, 8, 0.5), normals(random, 8, 0.0), normals(random, 9, 0.0)};
    for (double& x : strata[1]) x = 0.5 + 0.1 * x;  // a world of smaller spread
    for (double& x : strata[2]) x = 0.5 + 3.0 * x;
    const StratifiedComparison found = compare_strata(strata);
    const double truth = std::exp(0.5);
    covered += found.ratio_95->low <= truth && truth <= found.ratio_95->high ? 1 : 0;
  }
  // exact at 95 % or a little above; 400 trials have a standard deviation of 1.1 %
  EXPECT_GT(covered, 0.92 * kTrials);
  EXPECT_LT(covered, 0.99 * kTrials);
}

TEST(HodgesLehmann, TheIntervalAndTheTestAgree) {
  SequentialRandom random(7);
  for (int trial = 0; trial < 100; ++trial) {
    const Strata strata{normals(random, 8, 0.5), normals(random, 8, 0.4)};
    const StratifiedComparison found = compare_strata(strata);
    const bool excludes_one = found.ratio_95->low > 1.0 || found.ratio_95->high < 1.0;
    EXPECT_EQ(excludes_one, *found.p <= 0.05) << *found.p;
  }
}

TEST(Stratified, AManyTimesLargerStudyTakesTheNormalApproximation) {
  SequentialRandom random(8);
  const std::vector<double> d = normals(random, 300, 0.1);
  EXPECT_NEAR(*compare_strata(Strata{d}).p, *wilcoxon_signed_rank_p(d), 1e-3);
  Strata uneven;
  for (std::size_t n = 20; n < 40; ++n) uneven.push_back(normals(random, n, 0.0));
  const StratifiedComparison found = compare_strata(uneven);
  EXPECT_GT(*found.p, 0.001);
  EXPECT_NEAR(*found.ratio, 1.0, 0.2);
}

TEST(LogRatio, OfLostRunsIsInfiniteAndOfTwoLostRunsNone) {
  EXPECT_DOUBLE_EQ(*log_ratio(1.0, 2.0), std::log(2.0));
  EXPECT_EQ(log_ratio(0.0, 0.0), 0.0);
  EXPECT_EQ(log_ratio(1.0, kInfinite), kInfinite);
  EXPECT_EQ(log_ratio(kInfinite, 1.0), -kInfinite);
  EXPECT_EQ(log_ratio(1.0, -kInfinite), -kInfinite) << "lost where more is better: less than all";
  EXPECT_EQ(log_ratio(1.0, 0.0), -kInfinite);
  EXPECT_FALSE(log_ratio(kInfinite, kInfinite));
  EXPECT_FALSE(log_ratio(-1.0, 1.0));
}

TEST(Stratified, LostRunsAreTheFarthestEvidenceAndNoPairsAreNone) {
  const StratifiedComparison most = compare_strata(Strata{{kInfinite, kInfinite, kInfinite, -0.1}});
  EXPECT_EQ(*most.ratio, kInfinite);
  const StratifiedComparison even = compare_strata(Strata{{kInfinite, -kInfinite}});
  EXPECT_EQ(*even.p, 1.0);
  EXPECT_EQ(*even.ratio, 1.0);
  EXPECT_FALSE(compare_strata(Strata{}).ratio);
  EXPECT_FALSE(compare_strata(Strata{{0.0, 0.0}}).p) << "ties alone";
  EXPECT_EQ(*compare_strata(Strata{{0.0, 0.0}}).ratio, 1.0);
}

}  // namespace
}  // namespace lidarena::results
