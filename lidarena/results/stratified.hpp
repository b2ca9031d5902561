// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "lidarena/results/statistics.hpp"

/// Comparison of two methods by the ratios of their figures on the same flights, over worlds whose
/// scales may differ.
namespace lidarena::results {

/// log(b / a): +-infinite where one of the two is that of a lost run or zero. Empty where the pair
/// carries no evidence (both lost), and for figures below zero.
std::optional<double> log_ratio(double a, double b);

struct StratifiedComparison {
  std::size_t pairs = 0;
  bool b_is_smaller = false;         ///< whether the ranks say so
  std::optional<double> p;           ///< two-sided; empty when all pairs are ties
  std::optional<double> ratio;       ///< b / a; infinite or zero where most pairs have one lost run
  std::optional<Interval> ratio_95;  ///< empty with too few pairs (five in one stratum)
};

/// Log ratios of pairs, those of one world in each stratum. The test is Wilcoxon's signed-rank test
/// within each stratum, the sums of ranks weighted by 1 / (n + 1) (van Elteren, "On the combination
/// of independent two-sample tests of Wilcoxon", 1960): exact by counting all combinations of signs
/// where that is quick, else the normal approximation. The ratio is that of Hodges and Lehmann
/// ("Estimates of location based on rank tests", 1963): the median of the means of any two log
/// ratios of a stratum, with the same weights; its interval is what the test does not reject at 5
/// %. With one stratum both are the ordinary ones.
StratifiedComparison compare_strata(std::span<const std::vector<double>> log_ratios);

}  // namespace lidarena::results
